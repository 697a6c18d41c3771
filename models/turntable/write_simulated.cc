// A simulated scene as a data set on disk.
#include <fmt/format.h>
#include <cmath>
#include <cstring>
#include <numbers>
#include "io/json_file.h"
#include "io/output_file.h"
#include "io/progress.h"
#include "io/units.h"
#include "models/turntable/simulate.h"

namespace scancal {
namespace {

Result<void> CheckScene(const TurntableScene& scene, const std::vector<SimulatedPlacement>& placements) {
  for (const SimulatedPlacement& placement : placements)
    for (const SimulatedProfile& profile : placement.profiles)
      for (const double y : profile.y)
        if (std::abs(y) > 10 * (std::hypot(scene.system.M(), scene.system.N()) + 1000))
          return Error{"placement " + placement.name + ": at " + std::to_string(profile.alpha / kDegree) +
                       " deg the profiler looks past the plate; use a narrower sweep"};
  return {};
}

Result<void> CheckNumbers(const TurntableScene& scene) {
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

std::string Influences(const TurntableScene& scene) {
  std::string list;
  for (const auto& [name, u] :
       {std::pair{"noise_y", scene.noise_y}, {"encoder_jitter", scene.encoder_jitter / kDegree}, {"form", scene.form}})
    if (u > 0) list += fmt::format("{}{}: {:g}", list.empty() ? "" : ", ", name, u);
  if (scene.line_correlation > 1)
    list += fmt::format("{}line_correlation: {:g}", list.empty() ? "" : ", ", scene.line_correlation);
  if (scene.one_plate && scene.form > 0) list += ", one_plate: yes";
  return list.empty() ? "" : "influences: {" + list + "}\n";
}

std::string DatasetYaml(const TurntableScene& scene, const std::vector<SimulatedPlacement>& placements,
                        ScanFileFormat format) {
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

Json Truth(const TurntableScene& scene, const std::vector<SimulatedPlacement>& placements) {
  Json truth;
  truth["units"] = "mm, rad";
  const Quantities quantities = Turntable(Turntable::Residuals::kDepth).quantities();
  for (size_t k = 0; k < scene.system.q.size(); ++k) truth[quantities[k].name] = scene.system[k];
  if (scene.system[Turntable::kLinearity] != 0) truth["linearity_depths"] = WithDepths(scene).depths;
  truth["noise_y"] = scene.noise_y;
  truth["line_correlation"] = scene.line_correlation;
  truth["encoder_jitter"] = scene.encoder_jitter;
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

Result<void> WriteSimulatedTurntable(const TurntableScene& scene, ScanFileFormat format,
                                     const std::filesystem::path& folder) {
  SCANCAL_RETURN_IF_ERROR(CheckNumbers(scene));
  const std::vector<SimulatedPlacement> placements = SimulateTurntable(scene);
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

}  // namespace scancal
