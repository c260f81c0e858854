// NumPy arrays that show numbers of a result without copying them: read-only, and keeping their owner alive.
#pragma once

#include <pybind11/numpy.h>

#include <Eigen/Core>
#include <vector>

#include "tools/python/bindings.hpp"

namespace hb::python {

template <class Number>
py::array read_only(py::array_t<Number> array) {
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

// (rows, columns) of a column-major matrix inside `owner`.
template <class Number>
py::array view(const Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>& matrix, py::handle owner) {
  constexpr auto size = static_cast<py::ssize_t>(sizeof(Number));
  const std::vector<py::ssize_t> shape{matrix.rows(), matrix.cols()}, strides{size, size * matrix.rows()};
  return read_only(py::array_t<Number>(shape, strides, matrix.data(), owner));
}

// One member of each element of a vector inside `owner`.
template <class Element, class Number>
py::array view(const std::vector<Element>& elements, Number Element::*member, py::handle owner) {
  static const Element none{};
  const Element* data = elements.empty() ? &none : elements.data();
  const std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(elements.size())};
  const std::vector<py::ssize_t> strides{static_cast<py::ssize_t>(sizeof(Element))};
  return read_only(py::array_t<Number>(shape, strides, &(data->*member), owner));
}

// A fresh array of numbers computed for the caller alone.
template <class Derived>
py::array_t<typename Derived::Scalar> array_of(const Eigen::MatrixBase<Derived>& matrix) {
  py::array_t<typename Derived::Scalar> array(std::vector<py::ssize_t>{matrix.rows(), matrix.cols()});
  auto entries = array.template mutable_unchecked<2>();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) entries(i, k) = matrix(i, k);
  return array;
}

}  // namespace hb::python
