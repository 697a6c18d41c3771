// scancal simulate --model=turntable
#include <gflags/gflags.h>
#include <cstdio>
#include "apps/simulate.h"
#include "io/units.h"
#include "models/turntable/simulate.h"

DECLARE_string(out);
DECLARE_bool(declare);
DECLARE_uint64(seed);
DEFINE_double(M, 123, "turntable: offset of the profiler from the axis, mm");
DEFINE_double(N, 409, "turntable: offset of the profiler from the axis along depth, mm");
DEFINE_double(tilt_x, 0, "turntable: tilt of the profiler about its X, deg");
DEFINE_double(tilt_y, 0, "turntable: tilt of the profiler about its Y, deg");
DEFINE_double(scale_y, 0, "turntable: relative scale error of depth, true = shown (1 + this)");
DEFINE_double(scale_z, 0, "turntable: relative scale error along the line");
DEFINE_double(shear, 0, "turntable: error of the right angle between depth and line, deg");
DEFINE_double(linearity, 0, "turntable: error of depth that grows with the square of the distance from its middle, mm");
DEFINE_double(encoder_cos1, 0, "turntable: error of the encoder, once a turn, deg");
DEFINE_double(encoder_sin1, 0, "turntable: the same, a quarter turn on, deg");
DEFINE_double(encoder_cos2, 0, "turntable: error of the encoder, twice a turn, deg");
DEFINE_double(encoder_sin2, 0, "turntable: the same, an eighth of a turn on, deg");
DEFINE_double(expansion, 0, "turntable: relative expansion of the mount, which moves M and N");
DEFINE_int32(placements, 3, "turntable: placements of the plate");
DEFINE_int32(profiles, 200, "turntable: profiles per placement");
DEFINE_int32(points, 200, "turntable: points per profile");
DEFINE_double(sweep, 30, "turntable: sweep of the table, deg");
DEFINE_double(line_length, 200, "turntable: length of the laser line, mm");
DEFINE_double(noise, 0.05, "turntable: standard deviation along depth, mm");
DEFINE_double(line_correlation, 1,
              "turntable: integrated correlation length of the noise along the line, points; 1 is white");
DEFINE_double(encoder_jitter, 0, "turntable: standard deviation of the angle, one error a profile, deg");
DEFINE_double(form, 0, "turntable: smooth deviation of the plate over what the scan sees of it, mm rms");
DEFINE_string(form_kind, "modes",
              "turntable: modes (Legendre products, as u assumes), smooth (plane waves) or bent (long ones)");
DEFINE_bool(one_plate, false, "turntable: the same form in every placement");
DEFINE_double(outliers, 0, "turntable: share of points that are spikes, 0 to 1");
DEFINE_double(background, 0, "turntable: share of every line that sees a wall 30 to 60 mm behind the plate, 0 to 1");
DEFINE_double(missing, 0, "turntable: share of points without a return, 0 to 1");
DEFINE_double(search_width_M, 20, "turntable: width of the search interval of M, mm; it is not centred on the truth");
DEFINE_double(search_width_N, 30, "turntable: width of the search interval of N, mm");
DEFINE_string(format, "csv", "turntable: csv (angles to 1e-6 deg, lengths to 0.1 um) or npy (every digit)");

namespace scancal {
namespace {

// Each has a flag of its name.
const Quantities& SystemQuantities() {
  static const Quantities quantities = [] {
    Quantities all = Turntable(Turntable::Residuals::kDepth).quantities();
    all.resize(turntable::System::kQuantities);
    return all;
  }();
  return quantities;
}

double NumberOfFlag(const std::string& name) {
  return std::stod(gflags::GetCommandLineFlagInfoOrDie(name.c_str()).current_value);
}

int Run() {
  if (FLAGS_format != "csv" && FLAGS_format != "npy")
    return Complain("--format: found \"" + FLAGS_format + "\", expected csv or npy");
  if (FLAGS_form_kind != "modes" && FLAGS_form_kind != "smooth" && FLAGS_form_kind != "bent")
    return Complain("--form_kind: found \"" + FLAGS_form_kind + "\", expected modes, smooth or bent");
  TurntableScene scene;
  for (size_t k = 0; k < scene.system.q.size(); ++k) {
    const Quantity& quantity = SystemQuantities()[k];
    scene.system[k] = NumberOfFlag(quantity.name) * (quantity.unit == Unit::kRad ? kDegree : 1);
  }
  scene.placements = FLAGS_placements;
  scene.profiles = FLAGS_profiles;
  scene.points = FLAGS_points;
  scene.sweep = FLAGS_sweep * kDegree;
  scene.line_length = FLAGS_line_length;
  scene.noise_y = FLAGS_noise;
  scene.line_correlation = FLAGS_line_correlation;
  scene.encoder_jitter = FLAGS_encoder_jitter * kDegree;
  scene.form = FLAGS_form;
  scene.form_kind = FLAGS_form_kind == "modes"    ? FormKind::kModes
                    : FLAGS_form_kind == "smooth" ? FormKind::kSmooth
                                                  : FormKind::kBent;
  scene.one_plate = FLAGS_one_plate;
  scene.outliers = FLAGS_outliers;
  scene.background = FLAGS_background;
  scene.missing = FLAGS_missing;
  scene.declare = FLAGS_declare;
  scene.seed = FLAGS_seed;
  scene.search = SearchAround(scene.system, FLAGS_search_width_M, FLAGS_search_width_N);
  const auto format = FLAGS_format == "npy" ? ScanFileFormat::kNpy : ScanFileFormat::kCsv;
  const Result<void> written = WriteSimulatedTurntable(scene, format, FLAGS_out);
  if (!written.ok()) return Complain(written.error().message);
  std::printf(
      "wrote %s: %d placements x %d profiles x %d points, M = %g mm, N = %g mm, seed %llu; truth.json holds the "
      "truth\n",
      FLAGS_out.c_str(), scene.placements, scene.profiles, scene.points, FLAGS_M, FLAGS_N,
      static_cast<unsigned long long>(scene.seed));
  return kTrusted;
}

}  // namespace

Simulator TurntableSimulator() {
  std::vector<CommandFlag> flags;
  for (const Quantity& quantity : SystemQuantities()) flags.push_back({quantity.name.c_str()});
  for (const char* name : {"placements", "profiles", "points", "sweep", "line_length", "noise", "line_correlation",
                           "encoder_jitter", "form", "form_kind", "one_plate", "outliers", "background", "missing",
                           "search_width_M", "search_width_N", "format"})
    flags.push_back({name});
  return {"turntable", flags, &Run};
}

}  // namespace scancal
