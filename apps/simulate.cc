// scancal simulate
#include "models/turntable/simulate.h"
#include <gflags/gflags.h>
#include <algorithm>
#include <cstdio>
#include <string_view>
#include "apps/command.h"
#include "io/units.h"
#include "models/robot_ball/simulate.h"
#include "models/robot_profiler/simulate.h"
#include "models/turntable/artifact.h"

DECLARE_string(out);
DEFINE_string(model, "turntable", "what to simulate: turntable, robot-ball or robot-profiler");
DEFINE_bool(declare, false, "write what was simulated to dataset.yaml as influences");
DEFINE_uint64(seed, 1, "of all random numbers: the same seed gives the same files");

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
DEFINE_double(linearity_3, 0, "turntable: the same with its cube, mm at the ends");
DEFINE_double(lens_z2, 0, "turntable: error of depth with the square of z, mm at the ends of the line");
DEFINE_double(lens_yz, 0, "turntable: the same with depth times z");
DEFINE_double(lens_yz2, 0, "turntable: the same with depth times the square of z");
DEFINE_double(range_offset, 0, "turntable: offset of the range, mm");
DEFINE_double(range_scale, 0, "turntable: relative scale error of the range, of depth and line alike");
DEFINE_double(encoder_scale, 0, "turntable: relative error of the angle, true = shown (1 - this)");
DEFINE_bool(back, false, "turntable: the second half of the profiles sweeps back");
DEFINE_double(drift_sweep, 0, "turntable: by which the depth that is shown grows over each sweep, mm");
DEFINE_double(drift, 0, "turntable: by which the depth that is shown grows over all sweeps, mm");
DEFINE_double(angle_step, 0, "turntable: to which the written angle is rounded, deg; 0: not");
DEFINE_double(profile_offset, 0, "turntable: standard deviation of an error of depth common to a profile, mm");
DEFINE_double(profile_correlation, 0, "turntable: of that between neighbouring profiles");
DEFINE_int32(placements, 3, "turntable: placements of the plate");
DEFINE_int32(profiles, 200, "turntable: profiles per placement");
DEFINE_int32(points, 200, "turntable, robot-profiler: points per profile");
DEFINE_double(sweep, 30, "turntable: sweep of the table, deg");
DEFINE_double(line_length, 200, "turntable: length of the laser line, mm");
DEFINE_double(noise, 0.05, "turntable, robot-profiler: standard deviation along depth, mm");
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
DEFINE_string(format, "", "turntable: csv (angles to 1e-6 deg, lengths to 0.1 um; the default) or npy (every digit)");

DEFINE_bool(artifact, false, "turntable: in artifact/ also a ball bar and a step, for scancal verify");

DEFINE_int32(planes, 8, "robot-profiler: planes");
DEFINE_int32(stations, 8, "robot-ball: stations of the artifact");
DEFINE_int32(poses, 8, "robot-ball, robot-profiler: poses at each station, on each plane");
DEFINE_int32(translations, 6, "robot-ball: poses at the first station besides, that only translate");
DEFINE_string(configuration, "spatial", "robot-ball: how the poses of a station differ: spatial, planar or collinear");
DEFINE_double(ball_noise, 0.035, "robot-ball: standard deviation of a ball centre, mm per axis");
DEFINE_double(repeatability, 0.04,
              "robot-ball, robot-profiler: standard deviation of the flange's position, one a pose, mm per axis");
DEFINE_double(u_artifact, 0.001, "robot-ball: standard uncertainty of the artifact's centres, mm per axis");
DEFINE_int32(check_positions, 10, "robot-ball: positions of a two-ball scale that takes no part in the calibration");

namespace scancal {
namespace {

// Each has a flag of its name.
const Quantities& SystemQuantities() {
  static const Quantities quantities = [] {
    Quantities all = turntable::Model(turntable::Model::Residuals::kDepth).quantities();
    all.resize(turntable::System::kQuantities);
    return all;
  }();
  return quantities;
}

double NumberOfFlag(const std::string& name) {
  return std::stod(gflags::GetCommandLineFlagInfoOrDie(name.c_str()).current_value);
}

int RunTurntable() {
  if (!FLAGS_format.empty() && FLAGS_format != "csv" && FLAGS_format != "npy")
    return Complain("--format: found \"" + FLAGS_format + "\", expected csv or npy");
  if (FLAGS_form_kind != "modes" && FLAGS_form_kind != "smooth" && FLAGS_form_kind != "bent")
    return Complain("--form_kind: found \"" + FLAGS_form_kind + "\", expected modes, smooth or bent");
  turntable::Scene scene;
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
  scene.back = FLAGS_back;
  scene.drift_sweep = FLAGS_drift_sweep;
  scene.drift = FLAGS_drift;
  scene.angle_step = FLAGS_angle_step * kDegree;
  scene.profile_offset = FLAGS_profile_offset;
  scene.profile_correlation = FLAGS_profile_correlation;
  scene.encoder_jitter = FLAGS_encoder_jitter * kDegree;
  scene.form = FLAGS_form;
  scene.form_kind = FLAGS_form_kind == "modes"    ? turntable::FormKind::kModes
                    : FLAGS_form_kind == "smooth" ? turntable::FormKind::kSmooth
                                                  : turntable::FormKind::kBent;
  scene.one_plate = FLAGS_one_plate;
  scene.outliers = FLAGS_outliers;
  scene.background = FLAGS_background;
  scene.missing = FLAGS_missing;
  scene.declare = FLAGS_declare;
  scene.seed = FLAGS_seed;
  scene.search = turntable::SearchAround(scene.system, FLAGS_search_width_M, FLAGS_search_width_N);
  const auto format = FLAGS_format == "npy" ? turntable::ScanFileFormat::kNpy : turntable::ScanFileFormat::kCsv;
  Result<void> written = turntable::WriteSimulated(scene, format, FLAGS_out);
  if (written.ok() && FLAGS_artifact)
    written = turntable::WriteArtifact(scene, std::filesystem::path(FLAGS_out) / "artifact");
  if (!written.ok()) return Complain(written.error().message);
  std::printf(
      "wrote %s: %d placements x %d profiles x %d points, M = %g mm, N = %g mm, seed %llu; truth.json holds the "
      "truth\n",
      FLAGS_out.c_str(), scene.placements, scene.profiles, scene.points, FLAGS_M, FLAGS_N,
      static_cast<unsigned long long>(scene.seed));
  return kTrusted;
}

int RunRobot() {
  robot_ball::Scene scene;
  if (FLAGS_configuration == "planar") {
    scene.configuration = robot_ball::PoseConfiguration::kPlanar;
  } else if (FLAGS_configuration == "collinear") {
    scene.configuration = robot_ball::PoseConfiguration::kCollinear;
  } else if (FLAGS_configuration != "spatial") {
    return Complain("--configuration: found \"" + FLAGS_configuration + "\", expected spatial, planar or collinear");
  }
  scene.stations = FLAGS_stations;
  scene.poses = FLAGS_poses;
  scene.translations = FLAGS_translations;
  scene.ball_noise = FLAGS_ball_noise;
  scene.repeatability = FLAGS_repeatability;
  scene.u_spheres = FLAGS_u_artifact;
  scene.check_positions = FLAGS_check_positions;
  scene.seed = scene.noise_seed = FLAGS_seed;
  const Result<void> written = robot_ball::WriteSimulated(scene, FLAGS_declare, FLAGS_out);
  if (!written.ok()) return Complain(written.error().message);
  std::printf("wrote %s: %d stations x %d poses and %d that only translate, seed %llu; truth.json holds the truth\n",
              FLAGS_out.c_str(), scene.stations, scene.poses, scene.translations,
              static_cast<unsigned long long>(scene.seed));
  return kTrusted;
}

int RunProfiler() {
  robot_profiler::Scene scene;
  scene.planes = FLAGS_planes;
  scene.poses = FLAGS_poses;
  scene.points = FLAGS_points;
  scene.noise = FLAGS_noise;
  scene.repeatability = FLAGS_repeatability;
  scene.seed = scene.noise_seed = FLAGS_seed;
  const Result<void> written = robot_profiler::WriteSimulated(scene, FLAGS_declare, FLAGS_out);
  if (!written.ok()) return Complain(written.error().message);
  std::printf("wrote %s: %d planes x %d poses x %d points, seed %llu; truth.json holds the truth\n", FLAGS_out.c_str(),
              scene.planes, scene.poses, scene.points, static_cast<unsigned long long>(scene.seed));
  return kTrusted;
}

struct Simulator {
  const char* model;               // as in dataset.yaml
  std::vector<CommandFlag> flags;  // its own, in the order of the help; out, seed and declare belong to all
  int (*run)();                    // writes to --out; exit code
};

std::vector<Simulator> Simulators() {
  std::vector<CommandFlag> turntable;
  for (const Quantity& quantity : SystemQuantities()) turntable.push_back({quantity.name.c_str()});
  for (
      const char* name :
      {"placements",     "profiles",  "points",      "sweep",    "line_length", "noise",          "line_correlation",
       "encoder_jitter", "back",      "drift_sweep", "drift",    "angle_step",  "profile_offset", "profile_correlation",
       "form",           "form_kind", "one_plate",   "outliers", "background",  "missing",        "search_width_M",
       "search_width_N", "format",    "artifact"})
    turntable.push_back({name});
  return {{"turntable", turntable, &RunTurntable},
          {"robot-ball",
           {{"stations"},
            {"poses"},
            {"translations"},
            {"configuration"},
            {"ball_noise"},
            {"repeatability"},
            {"u_artifact"},
            {"check_positions"}},
           &RunRobot},
          {"robot-profiler", {{"planes"}, {"poses"}, {"points"}, {"noise"}, {"repeatability"}}, &RunProfiler}};
}

bool Has(const std::vector<CommandFlag>& flags, std::string_view name) {
  return std::any_of(flags.begin(), flags.end(), [&](const CommandFlag& flag) { return flag.name == name; });
}

std::vector<CommandFlag> Flags() {
  std::vector<CommandFlag> flags = {{"model"}, {"out", "folder of the data set to write"}, {"seed"}, {"declare"}};
  for (const Simulator& simulator : Simulators())
    for (const CommandFlag& flag : simulator.flags)
      if (!Has(flags, flag.name)) flags.push_back(flag);
  return flags;
}

int RunSimulate(const std::vector<std::string>& arguments) {
  if (!arguments.empty()) return Complain("simulate takes no argument; the folder is given by --out");
  if (FLAGS_out.empty()) return Complain("--out: expected the folder to write");
  const std::vector<Simulator> simulators = Simulators();
  const auto chosen = std::find_if(simulators.begin(), simulators.end(),
                                   [](const Simulator& each) { return FLAGS_model == each.model; });
  if (chosen == simulators.end())
    return Complain("--model: found \"" + FLAGS_model + "\", expected turntable, robot-ball or robot-profiler");
  for (const Simulator& other : simulators)
    for (const CommandFlag& flag : other.flags)
      if (!Has(chosen->flags, flag.name) && !gflags::GetCommandLineFlagInfoOrDie(flag.name).is_default)
        return Complain(std::string("--") + flag.name + " belongs to --model=" + other.model +
                        ", found --model=" + FLAGS_model);
  return chosen->run();
}

}  // namespace

const Command kSimulateCommand = {"simulate", "", "write a data set with known truth", Flags(), &RunSimulate};

}  // namespace scancal
