#include "hb/engine/steady/steady_state.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>

#include "hb/engine/steady/steady_bound.hpp"
#include "hb/engine/steady/steady_direct.hpp"
#include "hb/engine/steady/steady_iterative.hpp"
#include "hb/engine/steady/steady_operator.hpp"
#include "hb/engine/steady/steady_proof.hpp"
#include "hb/engine/steady/steady_residual.hpp"
#include "hb/engine/steady/truncation.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"
#include "lib/modulus.hpp"

namespace hb {

namespace {

using Index = Eigen::Index;
using steady::Spectrum;

// Share of the tolerance that the harmonics left out may take.
constexpr double truncation_share = 0.3;
// Below this many flops elimination goes first (a guess from its rate, not tuned).
constexpr double cheap_elimination = 1e5;
// Elimination behind the iteration is given up beyond this.
constexpr double most_bytes = 4e8;
// Response per load beyond which double precision cannot tell the operator from a singular one.
constexpr double singular_distance = 64 * eps;

// The equations as given, for residuals in extended precision: u = scale * T x solves `system`, rows scaled by
// T^-1 M^-1 and 1/scale are those of the scaled system.
struct Given {
  const HillSystem* system;
  double speed;
  double scale;
  Eigen::MatrixXd T, T_inverse;
  bool is_q;  // u is q itself, else q = load_scale * (T of the scaled system) * u

  Eigen::MatrixXd rows() const { return T_inverse * dense::inverse(system->mass); }
};

Spectrum padded(const Spectrum& x, Index H) {
  Spectrum result = Spectrum::Zero(H + 1, x.cols());
  const Index kept = std::min(H + 1, x.rows());
  result.topRows(kept) = x.topRows(kept);
  return result;
}

// An error of q over max |q|, which may be less than that of the q computed by the error; above 1 of no use, and
// finite.
double relative(double error, double largest) {
  return error < 0.5 * largest ? error / (largest - error) : 2 * error / largest;
}

class Solver {
 public:
  Solver(const ScaledSystem& scaled, const Given& given, const SteadyOptions& options)
      : scaled_(scaled), given_(given), options_(options), system_(steady::weighted(scaled)) {
    T_ = scaled.T * system_.weight.cwiseInverse().asDiagonal();
  }

  SteadyState run() {
    const Index most = std::max(1, options_.max_harmonics);
    const bool chosen = options_.num_harmonics > 0;
    Index H = chosen ? options_.num_harmonics
                     : steady::predicted_harmonics(system_, 0.1 * std::max(options_.tolerance, eps), most);
    Spectrum x = start();
    Index more = 0;  // harmonics than the window before
    for (;;) {
      steady::Operator A(system_, H);
      const bool last = chosen || H >= most;
      Index wanted = H;
      SteadyState state = on_window(A, x, last, wanted);
      products_ += A.num_products();
      if (wanted <= H || last) {
        state.iterations = state.method == SteadyMethod::direct ? factorisations_ : products_;
        return state;
      }
      // Beside a resonance each window shows few of those missing.
      more = std::max(wanted - H, 2 * more);
      H = std::min(H + more, most);
    }
  }

 private:
  // Solution on harmonics 0..H; `wanted` > H asks for more harmonics instead.
  SteadyState on_window(steady::Operator& A, Spectrum& x, bool last, Index& wanted) {
    const Index H = A.num_harmonics();
    SteadyState state;
    state.num_harmonics = static_cast<int>(H);
    std::unique_ptr<steady::Inverse> inverse;
    const steady::DirectCost cost = steady::DirectInverse::cost(system_, H);
    bool direct = options_.method == SteadyMethod::direct ||
                  (options_.method == SteadyMethod::automatic && cost.flops <= cheap_elimination);
    const bool may_eliminate = options_.method == SteadyMethod::automatic && cost.bytes <= most_bytes;

    const Spectrum start = x.rows() > 0 ? padded(x, H) : Spectrum::Zero(H + 1, system_.I);

    for (;;) {
      if (direct) {
        auto elimination = steady::eliminate(A);
        ++factorisations_;
        if (!elimination->regular()) return singular(state);
        inverse = std::move(elimination);
        state.method = SteadyMethod::direct;
      } else {
        inverse = std::make_unique<steady::IterativeInverse>(A);
        state.method = SteadyMethod::iterative;
      }
      x = start;
      Spectrum r;
      const bool solved = solve(A, *inverse, x, r);
      // The last harmonics that the exact residual shows: more of them first, whatever else is wrong.
      const double largest = steady::largest_over_turn(x * T_.transpose());
      Eigen::VectorXd beyond;
      if (solved && !last) {
        beyond = rows_beyond(H, r, A.noise());
        wanted = harmonics_for(A, largest, beyond, 1);
        if (wanted > H) return state;
      }
      if (solved && options_.without_bound) return unbounded(x, r, state);
      const double response = solved ? steady::response(A, *inverse, T_) : HUGE_VAL;
      if (std::isfinite(response)) {
        if (!last) {
          wanted = harmonics_for(A, largest, beyond, response);
          if (wanted > H) return state;
        }
        assess(A, *inverse, x, r, largest, response, state, wanted);
        if (wanted > H && !last) return state;
        if (state.status == SteadyStatus::converged) return state;
      }
      if (direct || !may_eliminate) {
        if (std::isfinite(response)) return state;
        // Without an answer: is it the operator's fault?
        if (!direct && cost.bytes <= most_bytes) {
          const auto elimination = steady::eliminate(A);
          if (!elimination->regular() || !(1 / steady::response(A, *elimination, T_) > singular_distance))
            return singular(state);
        }
        fail(x, state);
        return state;
      }
      direct = true;
    }
  }

  // Repeats inverse and exact residual until rounding or the tolerance stops it; `correction` adds the last digits.
  bool solve(steady::Operator& A, steady::Inverse& inverse, Spectrum& x, Spectrum& r) {
    const Index H = A.num_harmonics();
    const double relative = std::clamp(0.03 * options_.tolerance, 1e-14, 1e-3),
                 aim = options_.without_bound ? 0.5 * relative : std::clamp(1e-5 * options_.tolerance, 5e-15, 1e-3);
    double last = HUGE_VAL;
    Spectrum change;
    r = A.residual(x);
    const double load = A.scaled_norm(padded(system_.f, H));
    if (!(load > 0)) return std::isfinite(load);
    for (int pass = 0; pass < 8; ++pass) {
      const double now = A.scaled_norm(r);
      if (!std::isfinite(now)) return false;
      if (now <= relative * load) return true;
      if (!(now < 0.3 * last)) return now <= 1e-3 * load;
      last = now;
      inverse.solve(r.topRows(H + 1), std::max(aim * load / now, 1e-15), change);
      if (!change.allFinite()) return false;
      x += change;
      r = A.residual(x);
    }
    return A.scaled_norm(r) <= 1e-3 * load;
  }

  // Rows of r beyond harmonic H, divided by |D|, in q. Entries at or below `noise` are not counted, but for the load's
  // own, which have none.
  Eigen::VectorXd rows_beyond(Index H, const Spectrum& r, const Eigen::VectorXd& noise) const {
    Spectrum rows = r.bottomRows(r.rows() - H - 1);
    for (Index i = 0; i < rows.cols(); ++i)
      for (Index k = H + 1; k < r.rows(); ++k) {
        const bool loaded = k < system_.f.rows() && system_.f(k, i) != 0.0;
        if (!loaded && modulus(r(k, i)) <= noise(i)) rows(k - H - 1, i) = 0;
      }
    return steady::sizes_of_rows(system_, rows, H + 1, T_);
  }

  // Smallest window whose omitted residual rows stay within the share of the tolerance.
  Index harmonics_for(const steady::Operator& A, double largest, const Eigen::VectorXd& beyond, double response) const {
    const Index H = A.num_harmonics();
    const double allowed = truncation_share * options_.tolerance * largest;
    const double slack = steady::tail_slack(A, response);
    double sum = 0;
    Index k = H + beyond.size();
    for (; k > H; --k) {
      sum += 2 * slack * beyond(k - H - 1);
      if (!(sum <= allowed)) break;
    }
    return k > H ? std::max(k + 1, H + 2) : H;
  }

  // More harmonics where those left out are what is missing, else H.
  Index with_those_left_out(Index H, const steady::Correction& correction, double largest) const {
    const double missing = correction.outside + (correction.resonance_ahead ? correction.beyond : 0);
    return missing > 0.1 * options_.tolerance * largest ? H + std::max<Index>({2, system_.P / 2, H / 4}) : H;
  }

  // The claim is hb/engine/README.md (S7).
  void assess(steady::Operator& A, steady::Inverse& inverse, Spectrum& x, const Spectrum& r, double largest,
              double response, SteadyState& state, Index& wanted) {
    const Index H = A.num_harmonics();
    state.resonance_distance = std::min(1.0, 1 / response);
    if (!(1 / response > singular_distance) || steady::resonant_beyond(system_, H)) {
      singular(state);
      return;
    }
    const double load = steady::wiener_norms(system_.f).sum();
    const double rounding = steady::amplified(A.rounding(x), response, T_);
    const auto in_given_units = [&] {
      return Eigen::MatrixXcd(given_.scale * (given_.T * system_.weight.cwiseInverse().asDiagonal() * x.transpose()));
    };
    if (rounding > options_.tolerance * largest) {  // what a residual in double precision says is not enough
      state.error_bound = HUGE_VAL;
      Eigen::MatrixXcd u = in_given_units();
      refine(A, inverse, response, 0.1 * options_.tolerance, u, state, wanted);
      if (wanted > H || state.status == SteadyStatus::converged) {
        state.q = result(u);
        if (options_.bound == SteadyBound::proved) prove(A, u, state);
        return;
      }
    }
    const double enough = 0.1 * options_.tolerance * largest, hidden = std::min(enough, rounding),
                 negligible = std::max(std::min(enough, 1e-3 * options_.tolerance * largest), hidden);
    const steady::Correction correction = steady::correction(A, inverse, r, response, T_, enough, negligible, hidden);
    if (correction.window.allFinite() && std::isfinite(correction.rest)) {
      x += correction.window;
      if (steady::size_in_q(correction.window, T_) > 1e-6 * largest)
        largest = steady::largest_over_turn(x * T_.transpose());
    }
    const double error = correction.outside + correction.beyond + correction.rest + rounding;
    const double conversion = 4 * eps * static_cast<double>(system_.I) * steady::size_in_q(x, T_.cwiseAbs());
    state.residual = steady::wiener_norms(r).sum() / load;
    state.error_bound = relative(error + conversion, largest);
    state.status = state.error_bound <= options_.tolerance ? SteadyStatus::converged : SteadyStatus::not_reached;
    Eigen::MatrixXcd u = in_given_units();
    if (state.status != SteadyStatus::converged) wanted = with_those_left_out(H, correction, largest);
    if (state.status != SteadyStatus::converged && wanted == H && std::isfinite(state.error_bound))
      refine(A, inverse, response, options_.tolerance, u, state, wanted);
    state.q = result(u);
    if (options_.bound == SteadyBound::proved) prove(A, u, state);
  }

  struct Residual {
    Spectrum r;  // weighted rows, of u as it is stored
    Eigen::MatrixXd rounding;
    double largest;  // of q / load_scale over the turn, at sample points
    double conversion;  // what the last multiplication by T adds when u is not q itself
  };
  Residual extended_residual(const Eigen::MatrixXcd& u) const {
    const Eigen::MatrixXd to_u = given_.T * system_.weight.cwiseInverse().asDiagonal();
    const Eigen::MatrixXd rows = system_.weight.asDiagonal() * given_.rows();
    const steady::AccurateResidual accurate =
        steady::accurate_residual(*given_.system, given_.speed, FourierSeries(u), given_.scale);
    Residual residual;
    residual.r = accurate.r * (rows / (given_.speed * given_.speed)).transpose();
    residual.rounding = accurate.rounding * rows.cwiseAbs().transpose() / (given_.speed * given_.speed) +
                        8 * eps * static_cast<double>(system_.I) * residual.r.cwiseAbs();
    const Spectrum x = (u * (1 / given_.scale)).transpose() * dense::inverse(to_u).transpose();
    residual.largest = steady::largest_over_turn(x * T_.transpose());
    residual.conversion =
        given_.is_q ? 0 : 4 * eps * static_cast<double>(system_.I) * steady::size_in_q(x, T_.cwiseAbs());
    return residual;
  }

  // The estimate gives way to a proof if there is one; it stays otherwise.
  void prove(const steady::Operator& A, const Eigen::MatrixXcd& u, SteadyState& state) const {
    constexpr Index most_unknowns = 1000;  // a second or so
    const Residual residual = extended_residual(u);
    for (Index N = A.num_harmonics(); steady::proof_size(system_, N) <= most_unknowns; N *= 2) {
      const steady::Proof proof = steady::prove_error(system_, T_, N, residual.r, residual.rounding);
      if (!std::isfinite(proof.error)) continue;
      state.error_bound = relative(proof.error + residual.conversion, residual.largest * (1 - 1e-10));
      state.bound = SteadyBound::proved;
      state.status = state.error_bound <= options_.tolerance ? SteadyStatus::converged : SteadyStatus::not_reached;
      return;
    }
  }

  // Residuals in extended precision, of u as it is stored: its own rounding is then part of the residual.
  void refine(steady::Operator& A, steady::Inverse& inverse, double response, double enough, Eigen::MatrixXcd& u,
              SteadyState& state, Index& wanted) {
    const Index H = A.num_harmonics();
    const Eigen::MatrixXd to_u = given_.T * system_.weight.cwiseInverse().asDiagonal();
    const double load = steady::wiener_norms(system_.f).sum();
    Eigen::MatrixXcd best = u;
    double last = HUGE_VAL;
    for (int pass = 0; pass < 8; ++pass) {
      const Residual residual = extended_residual(u);
      if (pass == 0) {
        const Eigen::VectorXd beyond = rows_beyond(H, residual.r, Eigen::VectorXd::Zero(system_.I));
        wanted = harmonics_for(A, residual.largest, beyond, response);
        if (wanted > H) return;
      }
      const steady::Correction correction = steady::correction(A, inverse, residual.r, response, T_);
      if (!std::isfinite(correction.rest)) break;
      const double inner = steady::size_in_q(correction.window, T_) + correction.rest +
                           steady::amplified(A, residual.rounding.topRows(H + 1), response, T_);
      const double bound =
          relative(correction.outside + correction.beyond + inner + residual.conversion, residual.largest);
      if (bound < state.error_bound) {
        state.error_bound = bound;
        state.residual = steady::wiener_norms(residual.r).sum() / load;
        best = u;
      }
      if (state.error_bound <= enough) break;
      if (!(inner < 0.5 * last)) break;
      last = inner;
      u += given_.scale * to_u * correction.window.transpose();
    }
    u = best;
    if (state.error_bound <= options_.tolerance) state.status = SteadyStatus::converged;
  }

  FourierSeries result(const Eigen::MatrixXcd& u) const {
    FourierSeries q(given_.is_q ? u : Eigen::MatrixXcd(scaled_.load_scale * scaled_.T * u));
    q.c.col(0) = q.c.col(0).real().cast<std::complex<double>>().eval();
    return q;
  }

  SteadyState& singular(SteadyState& state) const {
    state.status = SteadyStatus::singular;
    state.q = FourierSeries();
    state.error_bound = HUGE_VAL;
    state.resonance_distance = std::min(state.resonance_distance, singular_distance);
    return state;
  }

  // No usable answer: what there is, with no claim about it.
  void fail(const Spectrum& x, SteadyState& state) const {
    state.status = SteadyStatus::not_reached;
    state.error_bound = HUGE_VAL;
    state.residual = HUGE_VAL;
    state.resonance_distance = 0;
    state.q = FourierSeries(Eigen::MatrixXcd(scaled_.load_scale * (T_ * x.transpose())));
  }

  SteadyState& unbounded(const Spectrum& x, const Spectrum& r, SteadyState& state) const {
    fail(x, state);
    state.residual = steady::wiener_norms(r).sum() / steady::wiener_norms(system_.f).sum();
    state.q.c.col(0) = state.q.c.col(0).real().cast<std::complex<double>>().eval();
    return state;
  }

  // Empty where none was given.
  Spectrum start() const {
    const FourierSeries& q = options_.start;
    if (q.num_components() != system_.I || q.num_harmonics() < 0) return {};
    return (dense::inverse(T_) * q.c / scaled_.load_scale).transpose();
  }

  const ScaledSystem& scaled_;
  const Given& given_;
  const SteadyOptions& options_;
  steady::WeightedSystem system_;
  Eigen::MatrixXd T_;  // q = load_scale T_ x in weighted coordinates
  int products_ = 0, factorisations_ = 0;
};

SteadyState at_rest(Index num_modes) {
  SteadyState state;
  state.status = SteadyStatus::converged;
  state.q = FourierSeries(num_modes, 0);
  return state;
}

void require(const SteadyOptions& options) {
  if (!(options.tolerance > 0))
    throw std::invalid_argument("SteadyOptions: tolerance must be positive, is " + std::to_string(options.tolerance));
  if (!(options.num_harmonics >= 0))
    throw std::invalid_argument("SteadyOptions: num_harmonics must not be negative, is " +
                                std::to_string(options.num_harmonics));
  if (!(options.max_harmonics >= 1))
    throw std::invalid_argument("SteadyOptions: max_harmonics must be positive, is " +
                                std::to_string(options.max_harmonics));
}

}  // namespace

SteadyState solve_steady_state(const HillSystem& system, double speed, const SteadyOptions& options) {
  return solve_steady_state(system, scale_system(system, speed), options);
}

SteadyState solve_steady_state(const HillSystem& system, const ScaledSystem& scaled, const SteadyOptions& options) {
  require(options);
  if (scaled.load_scale == 0) return at_rest(system.num_modes());
  const Given given{&system, scaled.speed, scaled.load_scale, scaled.T, scaled.T_inverse, true};
  return Solver(scaled, given, options).run();
}

SteadyState solve_steady_state(const ScaledSystem& scaled, const SteadyOptions& options) {
  require(options);
  const Index I = scaled.num_modes();
  if (scaled.load_scale == 0) return at_rest(I);
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(I, I);
  system.damping = scaled.G;
  system.stiffness[0] = scaled.K;
  system.load[0] = scaled.f;
  const Given given{&system, 1, 1, Eigen::MatrixXd::Identity(I, I), Eigen::MatrixXd::Identity(I, I), false};
  return Solver(scaled, given, options).run();
}

}  // namespace hb
