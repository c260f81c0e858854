#include "hb/engine/system/stiffness_samples.hpp"

#include <vector>

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

MatrixXd by_modulation(const ScaledSystem& system, Index N) {
  const Modulation& modulation = system.modulation;
  const auto functions = modulation.samples(N);
  MatrixXd samples(N, system.K.num_components());
  with_functions(functions.cols(), [&](auto r) {
    for (Index q = 0; q < samples.cols(); ++q) {
      const double mean = system.K.c(q, 0).real();
      const double* const function = functions.data();
      double* const entry = samples.col(q).data();
      for (Index n = 0; n < N; ++n) {
        double sum = mean;
        for (Index m = 0; m < r; ++m) sum += modulation.shares(q, m) * function[N * m + n];
        entry[n] = sum;
      }
    }
  });
  return samples;
}

// Of two entries that are equal in transposed places one is sampled.
struct DifferentEntries {
  std::vector<Index> places;
  std::vector<Index> serving;  // for each of the I*I places which of those
};

DifferentEntries different_entries(const FourierSeries& K, Index I) {
  DifferentEntries entries;
  entries.places.reserve(std::size_t(I * I));
  entries.serving.resize(std::size_t(I * I));
  for (Index j = 0; j < I; ++j)
    for (Index i = 0; i < I; ++i) {
      const Index here = i + I * j, transposed = j + I * i;
      const bool copy = i < j && K.c.row(here) == K.c.row(transposed);
      entries.serving[std::size_t(here)] =
          copy ? entries.serving[std::size_t(transposed)] : Index(entries.places.size());
      if (!copy) entries.places.push_back(here);
    }
  return entries;
}

}  // namespace

MatrixXd stiffness_samples(const ScaledSystem& system, Index N) {
  if (system.modulation.found()) return by_modulation(system, N);
  const FourierSeries& K = system.K;
  const DifferentEntries entries = different_entries(K, system.num_modes());
  fourier::RealTransform& transform = fourier::thread_transform(N, Index(entries.places.size()));
  auto spectrum = transform.spectrum();
  for (Index q = 0; q < spectrum.cols(); ++q)
    spectrum.col(q).head(K.c.cols()) = K.c.row(entries.places[std::size_t(q)]);
  spectrum.bottomRows(spectrum.rows() - K.c.cols()).setZero();
  transform.backward();
  MatrixXd samples(N, K.num_components());
  for (Index q = 0; q < samples.cols(); ++q) samples.col(q) = transform.samples().col(entries.serving[std::size_t(q)]);
  return samples;
}

}  // namespace hb
