// The command's tables as (column names, numbers): the same numbers in the same units as its CSV files.
#pragma once

#include "tools/output/csv_output.hpp"
#include "tools/python/arrays.hpp"

namespace hb::python {

// Bytes as text; what is not UTF-8 as replacement characters.
[[nodiscard]] inline py::str decoded(const std::string& bytes) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "replace"));
}

[[nodiscard]] inline py::list decoded(const std::vector<std::string>& lines) {
  py::list list;
  for (const std::string& line : lines) list.append(decoded(line));
  return list;
}

[[nodiscard]] inline py::tuple table_of(const tools::CsvFile& file) {
  return py::make_tuple(decoded(file.columns), array_of(file.rows));
}

}  // namespace hb::python
