// scancal simulate --model=robot-ball
#include <gflags/gflags.h>
#include <cstdio>
#include "apps/simulate.h"
#include "models/robot_ball/simulate.h"

DECLARE_string(out);
DECLARE_bool(declare);
DECLARE_uint64(seed);
DEFINE_int32(stations, 8, "robot-ball: stations of the artifact");
DEFINE_int32(poses, 8, "robot-ball: poses at each station");
DEFINE_int32(translations, 6, "robot-ball: poses at the first station besides, that only translate");
DEFINE_string(configuration, "spatial", "robot-ball: how the poses of a station differ: spatial, planar or collinear");
DEFINE_double(ball_noise, 0.035, "robot-ball: standard deviation of a ball centre, mm per axis");
DEFINE_double(repeatability, 0.04, "robot-ball: standard deviation of the flange's position, one a pose, mm per axis");
DEFINE_double(u_artifact, 0.001, "robot-ball: standard uncertainty of the artifact's centres, mm per axis");
DEFINE_int32(check_positions, 10, "robot-ball: positions of a two-ball scale that takes no part in the calibration");

namespace scancal {
namespace {

int Run() {
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
  const Result<void> written = WriteSimulated(scene, FLAGS_declare, FLAGS_out);
  if (!written.ok()) return Complain(written.error().message);
  std::printf("wrote %s: %d stations x %d poses and %d that only translate, seed %llu; truth.json holds the truth\n",
              FLAGS_out.c_str(), scene.stations, scene.poses, scene.translations,
              static_cast<unsigned long long>(scene.seed));
  return kTrusted;
}

}  // namespace

Simulator RobotSimulator() {
  return {"robot-ball",
          {{"stations"},
           {"poses"},
           {"translations"},
           {"configuration"},
           {"ball_noise"},
           {"repeatability"},
           {"u_artifact"},
           {"check_positions"}},
          &Run};
}

}  // namespace scancal
