#include "models/turntable/simulate.h"
#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include "io/json_file.h"
#include "io/output_file.h"
#include "io/progress.h"
#include "models/turntable/compress.h"

namespace scancal::turntable {
namespace {

constexpr double kStandoff = 75;                         // mm from the profiler's zero to the plate, straight ahead
constexpr double kSpike = 30;                            // mm
constexpr double kNearestWall = 30, kFarthestWall = 60;  // mm behind the plate
constexpr int kNewtonSteps = 10, kRounds = 4;
constexpr double kSettled_mm = 1e-9;
constexpr double kLeastHalf = 1;  // mm: of what is seen of a plate by a single profile or point
// Placements have the streams 1, 2, ...
constexpr uint64_t kFormStreams = uint64_t{1} << 32, kBackgroundStreams = uint64_t{2} << 32,
                   kOffsetStreams = uint64_t{3} << 32;

struct Plate {
  Eigen::Vector3d normal, centre, across, up;
  PlateForm form;
};

// Names as in the paper for three placements: left, centre, right.
std::string NameOf(int placement, int placements) {
  static const char* const kThree[] = {"left", "centre", "right"};
  return placements == 3 ? kThree[placement] : "placement_" + std::to_string(placement + 1);
}

Plate PlacePlate(const Scene& scene, int placement) {
  // Turned about the axis from -25 to 25 degrees; leaning towards and away from the axis in turn, by 5 to 20 degrees.
  static constexpr double kLean[] = {12, -8, 16, -14, 6, -19};
  const double turned = scene.placements == 1 ? 0 : -25 + 50.0 * placement / (scene.placements - 1);
  const double lean = kLean[placement % 6] * kDegree, turn = turned * kDegree;
  Plate plate;
  plate.normal = {std::sin(turn) * std::cos(lean), -std::cos(turn) * std::cos(lean), std::sin(lean)};
  System straight = scene.system;
  for (const Model::Index k : Model::kBends) straight[k] = 0;
  plate.centre = straight.Point(0, kStandoff, 0);
  plate.across = plate.normal.cross(Eigen::Vector3d::UnitZ()).normalized();
  plate.up = plate.across.cross(plate.normal);
  return plate;
}

// The depth that the profiler shows where its encoder reads alpha and it sees z of the plate with its form. Affine in y
// but for form and linearity, whose slopes are small: a few steps settle it.
double ShownDepth(const System& system, const Plate& plate, double alpha, double z) {
  const ProfileInTable<double> in_table = system.At(alpha);
  const double by_y = plate.normal.dot(in_table.Turned(in_table.along_y));
  double y = 0;
  for (int k = 0; k < kNewtonSteps; ++k) {
    const Eigen::Vector3d p = in_table.Point(y, z, k == 0 ? 0 : system.Bend(y, z)) - plate.centre;
    const double height = k == 0 ? 0 : plate.form.At(plate.across.dot(p), plate.up.dot(p));
    const double step = (height - plate.normal.dot(p)) / by_y;
    y += step;
    if (k > 0 && std::abs(step) < kSettled_mm) break;
  }
  return y;
}

// From -extent / 2 to extent / 2.
double Spread(double extent, int index, int count) {
  return count == 1 ? 0 : extent * (static_cast<double>(index) / (count - 1) - 0.5);
}

// Where the table stands at a profile.
double AlphaOf(const Scene& scene, int profile) {
  if (!scene.back) return Spread(scene.sweep, profile, scene.profiles);
  const int there = (scene.profiles + 1) / 2;
  return profile < there ? Spread(scene.sweep, profile, there)
                         : -Spread(scene.sweep, profile - there, std::max(1, scene.profiles - there));
}

// What the scan sees of the plate, were it flat.
PlateRectangle ScannedRectangle(const Scene& scene, const System& system, const Plate& flat) {
  Eigen::AlignedBox2d box;
  for (int i = 0; i < scene.profiles; ++i) {
    for (int j = 0; j < scene.points; ++j) {
      const double alpha = AlphaOf(scene, i), z = Spread(scene.line_length, j, scene.points);
      const Eigen::Vector3d p = system.Point(alpha, ShownDepth(system, flat, alpha, z), z) - flat.centre;
      box.extend(Eigen::Vector2d(flat.across.dot(p), flat.up.dot(p)));
    }
  }
  const Eigen::Vector2d half = (box.sizes() / 2).cwiseMax(kLeastHalf);
  return {box.center().x(), box.center().y(), half.x(), half.y()};
}

PlateForm FormOf(const Scene& scene, const System& system, int placement, const Plate& flat) {
  if (scene.form == 0) return {};
  const uint64_t stream = kFormStreams + (scene.one_plate ? 0 : static_cast<uint64_t>(placement));
  return {scene.form_kind, scene.form, ScannedRectangle(scene, system, flat), Random(scene.seed, stream)};
}

// A wall behind the plate, seen at one end of each line.
class Background {
 public:
  Background(const Scene& scene, int placement)
      : random_(scene.seed, kBackgroundStreams + static_cast<uint64_t>(placement)),
        behind_(kNearestWall + (kFarthestWall - kNearestWall) * random_.Uniform()),
        points_(scene.points),
        covered_(static_cast<int>(std::lround(scene.background * scene.points))) {}
  void NextProfile() { at_start_ = random_.Uniform() < 0.5; }
  double Behind(int point) const {  // mm along depth
    const bool covered = at_start_ ? point < covered_ : point >= points_ - covered_;
    return covered ? behind_ : 0;
  }

 private:
  Random random_;
  double behind_;
  int points_, covered_;
  bool at_start_ = true;
};

Result<void> CheckScene(const Scene& scene, const std::vector<SimulatedPlacement>& placements) {
  for (const SimulatedPlacement& placement : placements)
    for (const SimulatedProfile& profile : placement.profiles)
      for (const double y : profile.y)
        if (std::abs(y) > 10 * (std::hypot(scene.system.M(), scene.system.N()) + 1000))
          return Error{"placement " + placement.name + ": at " + std::to_string(profile.alpha / kDegree) +
                       " deg the profiler looks past the plate; use a narrower sweep"};
  return {};
}

Result<void> CheckNumbers(const Scene& scene) {
  const auto is_share = [](double share) { return share >= 0 && share < 1; };
  const auto not_negative = [](double x) { return x >= 0 && std::isfinite(x); };
  for (const double number : scene.system.q)
    if (!std::isfinite(number)) return Error{"M, N, tilts and errors: expected finite numbers"};
  if (scene.placements < 1 || scene.profiles < 1 || scene.points < 1)
    return Error{"placements, profiles and points: expected one or more of each"};
  if (!is_share(scene.outliers) || !is_share(scene.background) || !is_share(scene.missing))
    return Error{"outliers, background and missing: expected shares from 0 to below 1"};
  if (!not_negative(scene.noise_y) || !not_negative(scene.encoder_jitter) || !not_negative(scene.form))
    return Error{"noise, jitter and form: expected numbers that are not negative"};
  if (!(std::abs(scene.profile_correlation) < 1) || !not_negative(scene.profile_offset))
    return Error{"profile offset and correlation: expected 0 or more, and less than 1"};
  if (!(scene.line_correlation >= 1)) return Error{"line correlation: expected 1 (white) or more points"};
  if (!(scene.sweep >= 0 && scene.sweep < std::numbers::pi)) return Error{"sweep: expected 0 to below 180 deg"};
  if (!(scene.line_length > 0)) return Error{"line length: expected more than 0 mm"};
  for (const size_t k : {0, 1})
    if (!(scene.search.lower[k] < scene.search.upper[k]) || !(scene.search.step > 0))
      return Error{"search: expected lower < upper and a step greater than zero"};
  return {};
}

// "-15.3", not "-15.300000": half the size of the sample.
void Append(double value, int decimals, std::string* text) {
  std::string digits = fmt::format("{:.{}f}", value, decimals);
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.back() == '.') digits.pop_back();
  *text += digits;
}

std::string CsvLine(double alpha, double y, double z) {
  std::string line;
  Append(alpha / kDegree, 6, &line);
  line += ',';
  if (!std::isnan(y)) Append(y, 4, &line);
  line += ',';
  Append(z, 4, &line);
  return line + "\n";
}

Result<void> WriteCsv(const SimulatedPlacement& placement, OutputFile* file) {
  SCANCAL_RETURN_IF_ERROR(file->Write("angle,y,z\n"));
  for (const SimulatedProfile& profile : placement.profiles)
    for (size_t i = 0; i < profile.y.size(); ++i)
      SCANCAL_RETURN_IF_ERROR(file->Write(CsvLine(profile.alpha, profile.y[i], profile.z[i])));
  return {};
}

// numpy format 1.0, float64, C order, shape (points, 3).
Result<void> WriteNpy(const SimulatedPlacement& placement, OutputFile* file) {
  size_t points = 0;
  for (const SimulatedProfile& profile : placement.profiles) points += profile.y.size();
  std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(points) + ", 3), }";
  header.resize((10 + header.size()) / 64 * 64 + 64 - 10, ' ');
  header.back() = '\n';
  const auto length = static_cast<uint16_t>(header.size());
  const char magic[] = {
      '\x93', 'N', 'U', 'M', 'P', 'Y', 1, 0, static_cast<char>(length & 255), static_cast<char>(length >> 8)};
  SCANCAL_RETURN_IF_ERROR(file->Write({magic, sizeof magic}));
  SCANCAL_RETURN_IF_ERROR(file->Write(header));
  for (const SimulatedProfile& profile : placement.profiles) {
    for (size_t i = 0; i < profile.y.size(); ++i) {
      const double row[] = {profile.alpha / kDegree, profile.y[i], profile.z[i]};
      char bytes[sizeof row];
      std::memcpy(bytes, row, sizeof row);
      SCANCAL_RETURN_IF_ERROR(file->Write({bytes, sizeof bytes}));
    }
  }
  return {};
}

std::string Influences(const Scene& scene) {
  std::string list;
  for (const auto& [name, u] : {std::pair{"noise_y", scene.noise_y},
                                {"encoder_jitter", scene.encoder_jitter / kDegree},
                                {"form", scene.form},
                                {"drift_sweep", std::abs(scene.drift_sweep)},
                                {"drift", std::abs(scene.drift)}})
    if (u > 0) list += fmt::format("{}{}: {:g}", list.empty() ? "" : ", ", name, u);
  if (scene.line_correlation > 1)
    list += fmt::format("{}line_correlation: {:g}", list.empty() ? "" : ", ", scene.line_correlation);
  if (scene.form > 0) list += scene.one_plate ? ", one_plate: yes" : ", one_plate: no";
  return list.empty() ? "" : "influences: {" + list + "}\n";
}

std::string DatasetYaml(const Scene& scene, const std::vector<SimulatedPlacement>& placements, ScanFileFormat format) {
  std::string yaml = fmt::format(
      "scancal: 1\nmodel: turntable\nname: simulated plate, {} placements, seed {}\nunits: {{length: mm, angle: deg}}\n"
      "rotation: clockwise  # seen from +Z of the table\nsearch: {{M: [{:g}, {:g}], N: [{:g}, {:g}], step: {:g}}}\n",
      placements.size(), scene.seed, scene.search.lower[0], scene.search.upper[0], scene.search.lower[1],
      scene.search.upper[1], scene.search.step);
  const bool csv = format == ScanFileFormat::kCsv;
  if (!csv) yaml += "columns: [angle, y, z]\n";
  if (scene.declare) yaml += Influences(scene);
  yaml += "targets:\n";
  for (const SimulatedPlacement& placement : placements)
    yaml += "  - {name: " + placement.name + ", scan: " + placement.name + (csv ? ".csv" : ".npy") + "}\n";
  return yaml;
}

Json Truth(const Scene& scene, const std::vector<SimulatedPlacement>& placements) {
  Json truth;
  truth["units"] = "mm, rad";
  const Quantities quantities = Model(Model::Residuals::kDepth).quantities();
  for (size_t k = 0; k < scene.system.q.size(); ++k) truth[quantities[k].name] = scene.system[k];
  if (scene.system.Bends()) truth["linearity_depths"] = WithDepths(scene).depths;
  truth["noise_y"] = scene.noise_y;
  truth["line_correlation"] = scene.line_correlation;
  truth["encoder_jitter"] = scene.encoder_jitter;
  for (const auto& [name, value] : {std::pair{"drift_sweep", scene.drift_sweep},
                                    {"drift", scene.drift},
                                    {"angle_step", scene.angle_step},
                                    {"profile_offset", scene.profile_offset},
                                    {"profile_correlation", scene.profile_correlation}})
    if (value != 0) truth[name] = value;
  truth["form"] = scene.form;
  if (scene.form > 0) {
    truth["form_kind"] = scene.form_kind == FormKind::kModes    ? "modes"
                         : scene.form_kind == FormKind::kSmooth ? "smooth"
                                                                : "bent";
    truth["one_plate"] = scene.one_plate;
  }
  truth["outliers"] = scene.outliers;
  if (scene.background > 0) truth["background"] = scene.background;
  truth["missing"] = scene.missing;
  truth["seed"] = scene.seed;
  truth["targets"] = Json::array();
  for (const SimulatedPlacement& placement : placements)
    truth["targets"].push_back({{"name", placement.name},
                                {"normal", {placement.normal[0], placement.normal[1], placement.normal[2]}},
                                {"distance", placement.distance}});
  return truth;
}

}  // namespace

System WithDepths(const Scene& scene) {
  System system = scene.system, shown = scene.system;
  if (!system.Bends()) return system;
  for (const Model::Index k : Model::kBends) shown[k] = 0;
  for (int round = 0; round < kRounds; ++round) {  // the depths that are shown depend on linearity a little
    std::vector<Placement> placements(static_cast<size_t>(scene.placements));
    for (int k = 0; k < scene.placements; ++k) {
      const Plate flat = PlacePlate(scene, k);
      for (int i = 0; i < scene.profiles; ++i) {
        const double alpha = Spread(scene.sweep, i, scene.profiles);
        std::vector<double> y, z;
        for (int j = 0; j < scene.points; ++j) {
          z.push_back(Spread(scene.line_length, j, scene.points));
          y.push_back(ShownDepth(shown, flat, alpha, z.back()));
        }
        placements[static_cast<size_t>(k)].profiles.push_back(CompressProfile(alpha, y, z, {}));
      }
    }
    system.depths = VolumeOf(placements).y;
    system.heights = VolumeOf(placements).z;
    shown = system;
  }
  return system;
}

GridBox SearchAround(const System& system, double width_M, double width_N) {
  const double lower_M = std::round(system.M() - 0.65 * width_M),
               lower_N = std::round(system.N() - 14.0 / 30 * width_N);
  return {{lower_M, lower_N}, {lower_M + width_M, lower_N + width_N}, 1};
}

std::vector<SimulatedPlacement> Simulate(const Scene& scene) {
  std::vector<SimulatedPlacement> placements;
  const System system = WithDepths(scene);
  const double correlation = (scene.line_correlation - 1) / (scene.line_correlation + 1);  // of neighbours, AR(1)
  for (int k = 0; k < scene.placements; ++k) {
    Random random(scene.seed, static_cast<uint64_t>(k) + 1);
    Plate plate = PlacePlate(scene, k);
    plate.form = FormOf(scene, system, k, plate);
    Background background(scene, k);
    SimulatedPlacement& placement = placements.emplace_back();
    placement.name = NameOf(k, scene.placements);
    placement.normal = plate.normal;
    placement.distance = plate.normal.dot(plate.centre);
    Random offsets(scene.seed, kOffsetStreams + static_cast<uint64_t>(k));
    double offset = 0;
    for (int i = 0; i < scene.profiles; ++i) {
      const double alpha = AlphaOf(scene, i), elapsed = scene.profiles > 1 ? i / (scene.profiles - 1.0) : 0;
      SimulatedProfile& profile = placement.profiles.emplace_back();
      profile.alpha = alpha + scene.encoder_jitter * random.Normal();
      if (scene.angle_step > 0) profile.alpha = std::round(profile.alpha / scene.angle_step) * scene.angle_step;
      const double kept = i == 0 ? 0 : scene.profile_correlation;
      offset = kept * offset + std::sqrt(1 - kept * kept) * scene.profile_offset * offsets.Normal();
      const double drifted = scene.drift_sweep * elapsed + scene.drift * (k + elapsed) / scene.placements + offset;
      background.NextProfile();
      double noise = random.Normal();
      for (int j = 0; j < scene.points; ++j) {
        const double z = Spread(scene.line_length, j, scene.points);
        if (j > 0) noise = correlation * noise + std::sqrt(1 - correlation * correlation) * random.Normal();
        double y = ShownDepth(system, plate, alpha, z) + background.Behind(j) + scene.noise_y * noise + drifted;
        // The same number of draws for every point, so that one kind of error does not shift the others.
        const double spike = random.Uniform(), how_far = random.Uniform(), lost = random.Uniform();
        if (spike < scene.outliers) y += kSpike * (2 * how_far - 1);
        if (lost < scene.missing) y = std::numeric_limits<double>::quiet_NaN();
        profile.y.push_back(y);
        profile.z.push_back(z);
      }
    }
  }
  return placements;
}

Result<void> WriteSimulated(const Scene& scene, ScanFileFormat format, const std::filesystem::path& folder) {
  SCANCAL_RETURN_IF_ERROR(CheckNumbers(scene));
  const std::vector<SimulatedPlacement> placements = Simulate(scene);
  SCANCAL_RETURN_IF_ERROR(CheckScene(scene, placements));
  for (size_t k = 0; k < placements.size(); ++k) {
    Progress progress("writing " + placements[k].name);
    const bool csv = format == ScanFileFormat::kCsv;
    SCANCAL_ASSIGN_OR_RETURN(OutputFile file,
                             OutputFile::Create(folder / (placements[k].name + (csv ? ".csv" : ".npy"))));
    SCANCAL_RETURN_IF_ERROR(csv ? WriteCsv(placements[k], &file) : WriteNpy(placements[k], &file));
    SCANCAL_RETURN_IF_ERROR(file.Commit());
  }
  SCANCAL_RETURN_IF_ERROR(WriteJson(folder / "truth.json", Truth(scene, placements)));
  return WriteFile(folder / "dataset.yaml", DatasetYaml(scene, placements, format));
}

}  // namespace scancal::turntable
