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
#include "solver/grid_search.h"
#include "solver/random.h"

namespace scancal::turntable {

enum class FormKind {
  kModes,   // those of FormModesAt, amplitudes independent and normal
  kSmooth,  // eight plane waves of random direction and phase, 3/4 to 2 sides of the rectangle long, its plane removed
  kBent,    // the same, 1 to 3 times as long as the longer side: mostly bent about one axis
};

struct PlateRectangle {  // on the plate, mm
  double centre_u = 0, centre_v = 0, half_u = 1, half_v = 1;
};

// Smooth form over a rectangle. rms, mm: of kModes expected over the ensemble, so that one plate may have twice as
// much; of the waves of every single plate, a function that the modes do not hold.
class PlateForm {
 public:
  PlateForm() = default;  // flat
  // The same random numbers give the same form, stretched to another rectangle.
  PlateForm(FormKind kind, double rms, const PlateRectangle& over, Random random);
  double At(double u, double v) const;  // along the normal, mm; at most a little beyond the rectangle

 private:
  struct Wave {
    double along_u, along_v, phase;  // rad per half side
  };
  void DrawModes(double rms, Random* random);
  void DrawWaves(FormKind kind, double rms, Random* random);
  double Waves(double u, double v) const;

  PlateRectangle over_;
  std::vector<double> modes_;  // amplitudes, mm
  std::vector<Wave> waves_;
  double amplitude_ = 0, plane_[3] = {0, 0, 0};  // of the waves
};

struct Scene {
  System system{{123, 409}, {}};  // its depths follow from the scene: WithDepths
  int placements = 3;
  int profiles = 200, points = 200;   // per placement, per profile
  double sweep = 30 * kDegree;        // rad, from -sweep/2 to sweep/2
  double line_length = 200;           // mm, along z
  double noise_y = 0.05;              // mm, standard deviation along depth
  double line_correlation = 1;        // points: integrated correlation length of that noise; 1 = white
  double encoder_jitter = 0;          // rad, one error a profile
  bool back = false;                  // the second half of the profiles sweeps back
  double drift_sweep = 0, drift = 0;  // mm, by which the depth that is shown grows over each sweep, over all of them
  double angle_step = 0;              // rad, to which the angle that is written is rounded; 0: not
  double profile_offset = 0;          // mm, standard deviation: of depth, common to a profile
  double profile_correlation = 0;     // of that between neighbouring profiles of a sweep
  double form = 0;                    // mm rms: smooth deviation of the plate over what the scan sees of it
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
System WithDepths(const Scene& scene);

// A search interval of these widths (mm) around M and N, at whole millimetres and not centred: as an installer would
// guess it. The published M 123, N 409 with widths 20 and 30 give the published [110, 130] x [395, 425].
GridBox SearchAround(const System& system, double width_M, double width_N);

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
std::vector<SimulatedPlacement> Simulate(const Scene& scene);

enum class ScanFileFormat { kCsv, kNpy };
// folder/dataset.yaml, folder/<placement>.csv and folder/truth.json. CSV rounds angles to 1e-6 deg, lengths to 0.1 um;
// npy keeps every digit. Refuses scenes that cannot be seen (the profiler looks past a plate, counts below one).
Result<void> WriteSimulated(const Scene& scene, ScanFileFormat format, const std::filesystem::path& folder);

}  // namespace scancal::turntable
