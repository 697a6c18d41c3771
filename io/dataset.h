// dataset.yaml: the half that every model shares. The rest is taken by the model from `yaml`, which then says Finish().
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>
#include "io/json.h"
#include "io/result.h"
#include "io/units.h"
#include "io/yaml.h"

namespace scancal {

// parameters: {tilt_x: estimate, tilt_y: {consider: 0, u: 0.0005}, M: {estimate: 123, u: 0.5}, N: {hold: 409}}
struct ParameterSetting {
  std::string name;
  std::string role;             // estimate | consider | hold
  std::optional<double> value;  // declared unit; absent: the model's nominal
  double u = 0;  // declared unit; consider: standard uncertainty, required > 0; estimate: of the prior, 0 = none
};

// influences: {noise_y: 0.05, encoder_jitter: estimate, form: {estimate: 0, u: 0.01}, one_plate: yes}
struct InfluenceSetting {
  std::string name;
  std::string role;  // consider (a number) | estimate | hold | yes | no
  double u = 0;      // declared unit, >= 0; estimate: of the prior, 0 = none
};

struct Dataset {
  std::filesystem::path file;  // .../dataset.yaml
  std::string text;            // all that it says
  std::string model, name;     // name: empty if not declared
  Units units;
  std::vector<ParameterSetting> parameters;
  std::vector<InfluenceSetting> influences;
  std::shared_ptr<const Json> certificate;  // null if absent
  YamlMap yaml;                             // what is left for the model
  std::string urdf;  // what the URDF says that it names, where calibration.json kept it; empty: it is read
};

// {length: mm, angle: deg}; what it leaves out is as `otherwise` says, or else required.
Units ReadUnits(YamlMap yaml, const std::optional<Units>& otherwise = {});

// folder: holds dataset.yaml, or that file itself. Checks the format version, units, roles, u >= 0; not yet unknown
// keys.
Result<Dataset> ReadDataset(const std::filesystem::path& folder);
// The same from its text; name: for messages.
Result<Dataset> ParseDataset(std::string text, const std::filesystem::path& file, const std::string& name);

}  // namespace scancal
