// What errors that curve along a profile do to its rows: the plate's form, the profiler's linearity.
#pragma once
#include <vector>
#include "models/turntable/profile.h"

namespace scancal {

// Both fill columns of the views: the error at the points of the profile, as the straight line that it looks like
// there. What is left of it bends the profile; that moves no plane, and is lost in the noise of single points.

// `form` of every view, the modes of form_modes.h. The plate's square is the rectangle that bounds the points as they
// lie on the plane n . P = d: across the plate at right angles to the table's axis, and up. It starts
// from the placement's own points, so one plate in all placements has one form only if its edges are in view.
void AddForm(const std::vector<Profile>& profiles, const turntable::System& system, const Eigen::Vector3d& normal,
             double distance, std::vector<Turntable::View>* views);

// `bend` of every view: eta^2, eta from -1 to 1 over the system's depths.
void AddBend(const turntable::System& system, const std::vector<Profile>& profiles,
             std::vector<Turntable::View>* views);

// For planes through the pseudo-points of a known system.
std::vector<Turntable::View> PlaneViews(const std::vector<Profile>& profiles, const turntable::System& system);
std::array<double, 3> PointOf(const turntable::ProfileInTable<double>& in_table, const Turntable::View& profile,
                              Eigen::Index point);

}  // namespace scancal
