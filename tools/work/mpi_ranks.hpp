// Ranks by MPI. The only part of the program that sees MPI; it is in hb_mpi, which hb turns into under mpirun.
#pragma once

#include "tools/work/ranks.hpp"

namespace hb::tools {

class MpiRanks : public Ranks {
 public:
  MpiRanks(int& argc, char**& argv);
  ~MpiRanks() override;
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  int size() const override;
  int rank() const override;
  std::vector<std::vector<double>> gathered(const std::vector<double>& own) const override;

  // After a failure: the other ranks may be waiting for this one. The first rank, which says what is wrong, goes first.
  void end_all(int status) const;
};

}  // namespace hb::tools
