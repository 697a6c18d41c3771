// Data sets of the turntable with known truth.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>
#include "io/result.h"
#include "io/units.h"
#include "models/turntable.h"
#include "models/turntable/plate_form.h"
#include "solver/grid_search.h"

namespace scancal {

struct TurntableScene {
  turntable::System system{{123, 409}, {}};  // its depths follow from the scene: WithDepths
  int placements = 3;
  int profiles = 200, points = 200;  // per placement, per profile
  double sweep = 30 * kDegree;       // rad, from -sweep/2 to sweep/2
  double line_length = 200;          // mm, along z
  double noise_y = 0.05;             // mm, standard deviation along depth
  double line_correlation = 1;       // points: integrated correlation length of that noise; 1 = white
  double encoder_jitter = 0;         // rad, one error a profile
  double form = 0;                   // mm rms: smooth deviation of the plate over what the scan sees of it
  FormKind form_kind = FormKind::kModes;
  bool one_plate = false;                     // the same form in every placement, not one of its own
  double outliers = 0;                        // share of points that are spikes within +-30 mm of the plate
  double background = 0;                      // share of every line, at either end, that sees a wall 30 to 60 mm behind
  double missing = 0;                         // share of points without a return
  GridBox search{{110, 395}, {130, 425}, 1};  // written to dataset.yaml
  bool declare = false;                       // write noise, jitter and form to dataset.yaml as influences
  uint64_t seed = 1;
};

// The scene's system with the depths of its scans, as whoever reads them will see them: what its linearity refers to.
turntable::System WithDepths(const TurntableScene& scene);

// A search interval of these widths (mm) around M and N, at whole millimetres and not centred: as an installer would
// guess it. The published M 123, N 409 with widths 20 and 30 give the published [110, 130] x [395, 425].
GridBox SearchAround(const turntable::System& system, double width_M, double width_N);

struct SimulatedProfile {
  double alpha = 0;          // as recorded: with jitter
  std::vector<double> y, z;  // mm; y is nan where there is no return
};

struct SimulatedPlacement {
  std::string name;
  Eigen::Vector3d normal;  // truth
  double distance = 0;
  std::vector<SimulatedProfile> profiles;
};

// Placements of a plate that lean by 5 to 20 degrees from the axis and are turned about it by up to +-25 degrees, 75 mm
// in front of the profiler. Noise, form and background of each placement are streams of the seed: the same for any
// number of placements, and none shifts the others.
std::vector<SimulatedPlacement> SimulateTurntable(const TurntableScene& scene);

enum class ScanFileFormat { kCsv, kNpy };
// folder/dataset.yaml, folder/<placement>.csv and folder/truth.json. CSV rounds angles to 1e-6 deg, lengths to 0.1 um;
// npy keeps every digit. Refuses scenes that cannot be seen (the profiler looks past a plate, counts below one).
Result<void> WriteSimulatedTurntable(const TurntableScene& scene, ScanFileFormat format,
                                     const std::filesystem::path& folder);

}  // namespace scancal
