#include "tools/python/errors.hpp"

#include <cctype>

#include "hb/analysis/request.hpp"
#include "lib/scene/scene.hpp"
#include "tools/command/command.hpp"

namespace hb::python {
namespace {

py::object exception(const char* name) { return py::module_::import("hb.errors").attr(name); }

void set_error(const py::object& type, const py::object& instance) { PyErr_SetObject(type.ptr(), instance.ptr()); }

// "--over rpm: found ..., WHY; allowed: ..." of the command line.
struct Refusal {
  std::string field, found, allowed;
};

Refusal refusal(const std::string& text) {
  Refusal parts;
  const std::size_t colon = text.find(": ");
  if (colon == std::string::npos) return {"", text, ""};
  parts.field = text.substr(0, colon);
  const std::string rest = text.substr(colon + 2);
  const std::size_t allowed = rest.find("allowed");
  parts.found = rest.substr(0, allowed);
  if (allowed != std::string::npos) parts.allowed = rest.substr(allowed + 7);
  if (parts.found.starts_with("found ")) parts.found.erase(0, 6);
  while (!parts.found.empty() && std::string(" ,;").find(parts.found.back()) != std::string::npos)
    parts.found.pop_back();
  while (!parts.allowed.empty() && std::string(" :").find(parts.allowed.front()) != std::string::npos)
    parts.allowed.erase(0, 1);
  return parts;
}

void set_request_error(std::string message, std::string field, const std::string& found, const std::string& allowed) {
  // Arguments are called as in Python.
  if (field == "tolerance") {
    field = "tol";
    message.replace(0, std::string("tolerance").size(), field);
  }
  const py::object type = exception("RequestError");
  set_error(type, type(message, field, found, allowed));
}

}  // namespace

std::string as_argument(std::string text) {
  for (std::size_t at = 0; (at = text.find("--", at)) != std::string::npos;) {
    const bool begins = at == 0 || std::isalnum(static_cast<unsigned char>(text[at - 1])) == 0;
    const bool word = at + 2 < text.size() && std::isalpha(static_cast<unsigned char>(text[at + 2])) != 0;
    if (begins && word) {
      text.erase(at, 2);
    } else {
      at += 2;
    }
  }
  return text;
}

void add_errors(py::module_&) {
  py::register_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const SceneError& error) {
      const py::object type = exception("SceneError");
      set_error(type, type(py::reinterpret_steal<py::object>(PyUnicode_DecodeUTF8(
                          error.what(), static_cast<Py_ssize_t>(std::string(error.what()).size()), "replace"))));
    } catch (const RequestError& error) {
      set_request_error(error.what(), error.field, error.found, error.allowed);
    } catch (const tools::UsageError& error) {
      const std::string message = as_argument(error.what());
      const Refusal parts = refusal(message);
      set_request_error(message, parts.field, parts.found, parts.allowed);
    } catch (const tools::OutputError& error) {
      // "--out: PATH cannot be written: REASON" of the command line.
      const std::string message = error.what();
      const std::string flag = "--out: ";
      PyErr_SetString(PyExc_OSError, message.substr(message.starts_with(flag) ? flag.size() : 0).c_str());
    }
  });
}

}  // namespace hb::python
