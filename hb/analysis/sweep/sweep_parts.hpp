// Points of a sweep as lists of numbers (hb/engine/boundaries/part.hpp).
#pragma once

#include "hb/analysis/sweep_analysis.hpp"
#include "hb/engine/boundaries/part.hpp"

namespace hb {

template <class Visit>
void visit_range(Visit& visit, TurnRange& range) {
  visit(range.min);
  visit(range.max);
}

template <class Visit>
void visit_stress(Visit& visit, StressPoint& stress) {
  for (double* value : {&stress.axial, &stress.bending, &stress.axial_error, &stress.bending_error, &stress.max_abs,
                        &stress.mean, &stress.amplitude, &stress.x, &stress.crank_angle, &stress.error,
                        &stress.yield_safety_error, &stress.fatigue_safety_error})
    visit(*value);
  visit_if_there(visit, stress.yield_safety, visit);
  visit_if_there(visit, stress.fatigue_safety, visit);
}

template <class Visit>
void visit_machine(Visit& visit, MachinePoint& machine) {
  visit_elements(visit, machine.bearings, visit);
  visit(machine.shaking_force);
  visit_range(visit, machine.shaking_moment);
  Drive& drive = machine.drive;
  for (double* value : {&drive.mean, &drive.rms, &drive.mean_power, &drive.rms_power, &drive.largest_power,
                        &drive.smallest_power, &drive.energy_fluctuation})
    visit(*value);
  visit_if_there(visit, machine.speed_fluctuation, visit);
  visit_if_there(visit, machine.speed_fluctuation_error, visit);
  for (double* value : {&machine.bearing_error, &machine.shaking_force_error, &machine.shaking_moment_error,
                        &machine.torque_error, &machine.power_error, &machine.energy_error})
    visit(*value);
}

template <class Visit>
void visit_point(Visit& visit, SweepPoint& point) {
  visit(point.x);
  visit(point.speed);
  visit_elements(visit, point.problem, [&](char& c) { visit_as_number(visit, c); });
  visit_elements(visit, point.theory_reason, [&](char& c) { visit_as_number(visit, c); });
  visit_if_there(visit, point.force_theory_error, visit);
  visit_if_there(visit, point.torque_theory_error, visit);
  visit_if_there(visit, point.mean_torque_theory_error, visit);
  visit_if_there(visit, point.growth_theory_error, visit);
  visit_elements(visit, point.rods, [&](RodPoint& rod) {
    visit_if_there(visit, rod.steady, [&](SteadyStatus& status) { visit_as_number(visit, status); });
    visit_as_number(visit, rod.num_harmonics);
    visit(rod.error_bound);
    visit(rod.resonance_distance);
    visit_elements(visit, rod.max_abs, visit);
    visit_if_there(visit, rod.deflection, visit);
    visit_if_there(visit, rod.bending_moment, visit);
    visit_if_there(visit, rod.deflection_error, visit);
    visit_if_there(visit, rod.bending_moment_error, visit);
    visit_if_there(visit, rod.buckling_share, visit);
    visit_if_there(visit, rod.buckling_share_error, visit);
    visit_if_there(visit, rod.strain, visit);
    visit_if_there(visit, rod.stress, [&](StressPoint& stress) { visit_stress(visit, stress); });
    visit_if_there(visit, rod.theory_error, visit);
    visit_if_there(visit, rod.deflection_theory_error, visit);
    visit_if_there(visit, rod.stability, [&](StabilitySample& sample) { visit_sample(visit, sample); });
  });
  visit_elements(visit, point.joints, [&](TurnRange& range) { visit_range(visit, range); });
  visit_elements(visit, point.joints_rigid, [&](TurnRange& range) { visit_range(visit, range); });
  visit_if_there(visit, point.torque, [&](TurnRange& range) { visit_range(visit, range); });
  visit_if_there(visit, point.torque_rigid, [&](TurnRange& range) { visit_range(visit, range); });
  visit_if_there(visit, point.force_errors, [&](ForceErrors& errors) {
    for (double* value : {&errors.force, &errors.torque, &errors.force_cut, &errors.torque_cut}) visit(*value);
  });
  visit_if_there(visit, point.machine, [&](MachinePoint& machine) { visit_machine(visit, machine); });
}

template <class Visit>
void visit_critical(Visit& visit, CriticalPoint& point) {
  visit_as_number(visit, point.rod);
  visit_as_number(visit, point.component);
  visit_as_number(visit, point.mode);
  visit_as_number(visit, point.order);
  visit(point.frequency);
  visit(point.damping);
  visit(point.speed);
  visit(point.prominence);
  visit(point.peak.x);
  visit(point.peak.value);
  visit(point.peak.error);
  visit_as_number(visit, point.peak.converged);
}

}  // namespace hb
