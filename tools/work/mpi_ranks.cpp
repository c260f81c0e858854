#include "tools/work/mpi_ranks.hpp"

#include <mpi.h>

#include <chrono>
#include <cstddef>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <thread>

namespace hb::tools {

MpiRanks::MpiRanks(int& argc, char**& argv) { MPI_Init(&argc, &argv); }

MpiRanks::~MpiRanks() { MPI_Finalize(); }

int MpiRanks::size() const {
  int size = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}

int MpiRanks::rank() const {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

void MpiRanks::end_all(int status) const {
  if (!first()) std::this_thread::sleep_for(std::chrono::seconds(2));
  MPI_Abort(MPI_COMM_WORLD, status);
}

std::vector<std::vector<double>> MpiRanks::gathered(const std::vector<double>& own) const {
  const auto num = static_cast<std::size_t>(size());
  const int count = static_cast<int>(own.size());
  std::vector<int> counts(num), starts(num, 0);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, MPI_COMM_WORLD);
  const std::size_t total = std::accumulate(counts.begin(), counts.end(), std::size_t(0));
  if (total > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw std::length_error("too many numbers to exchange at once between the ranks");
  std::exclusive_scan(counts.begin(), counts.end(), starts.begin(), 0);
  std::vector<double> all(total);
  MPI_Allgatherv(own.data(), count, MPI_DOUBLE, all.data(), counts.data(), starts.data(), MPI_DOUBLE, MPI_COMM_WORLD);
  std::vector<std::vector<double>> result(num);
  for (std::size_t r = 0; r < num; ++r) result[r].assign(all.begin() + starts[r], all.begin() + starts[r] + counts[r]);
  return result;
}

}  // namespace hb::tools
