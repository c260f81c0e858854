// What one integration by CVODE owns. Used by the sources that integrate.
#pragma once

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>

#include <new>
#include <stdexcept>
#include <string>

namespace hb {

struct SundialsSession {
  SUNContext context = nullptr;
  N_Vector y = nullptr;
  SUNLinearSolver solver = nullptr;
  void* cvode = nullptr;

  SundialsSession() {
    if (SUNContext_Create(nullptr, &context) != 0) throw std::bad_alloc();
  }
  SundialsSession(const SundialsSession&) = delete;
  SundialsSession& operator=(const SundialsSession&) = delete;
  ~SundialsSession() {
    if (cvode != nullptr) CVodeFree(&cvode);
    if (solver != nullptr) SUNLinSolFreeEmpty(solver);
    if (y != nullptr) N_VDestroy(y);
    SUNContext_Free(&context);
  }
};

inline void require_success(int flag, const char* call) {
  if (flag != CV_SUCCESS) throw std::runtime_error(std::string(call) + " failed with " + std::to_string(flag));
}

}  // namespace hb
