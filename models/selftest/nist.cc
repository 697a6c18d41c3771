// NIST's certified nonlinear regressions: their functions and their files.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <regex>
#include <sstream>
#include "io/delimited.h"
#include "io/message.h"
#include "io/number.h"
#include "models/selftest/fit.h"

namespace scancal::selftest {
namespace {

// As printed in the files, with b1 = b[0]: any T of b, the predictors x are double.

constexpr auto kSaturation = [](auto b, auto x) { return b[0] * (1.0 - exp(-b[1] * x[0])); };

constexpr auto kChwirut = [](auto b, auto x) { return exp(-b[0] * x[0]) / (b[1] + b[2] * x[0]); };

constexpr auto kCubicByCubic = [](auto b, auto x) {
  return (b[0] + x[0] * (b[1] + x[0] * (b[2] + x[0] * b[3]))) / (1.0 + x[0] * (b[4] + x[0] * (b[5] + x[0] * b[6])));
};

constexpr auto kLanczos = [](auto b, auto x) {
  return b[0] * exp(-b[1] * x[0]) + b[2] * exp(-b[3] * x[0]) + b[4] * exp(-b[5] * x[0]);
};

constexpr auto kGauss = [](auto b, auto x) {
  const auto s = (x[0] - b[3]) / b[4], t = (x[0] - b[6]) / b[7];
  return b[0] * exp(-b[1] * x[0]) + b[2] * exp(-s * s) + b[5] * exp(-t * t);
};

constexpr auto kEnso = [](auto b, auto x) {
  const double turn = 2 * std::numbers::pi * x[0];
  const auto s = turn / b[3], t = turn / b[6];
  return b[0] + b[1] * cos(turn / 12) + b[2] * sin(turn / 12) + b[4] * cos(s) + b[5] * sin(s) + b[7] * cos(t) +
         b[8] * sin(t);
};

template <class F>
constexpr NistModel Of(const char* name, int parameters, F) {
  return {name, parameters, &PoseRegression<F>};
}

constexpr NistModel WithNote(NistModel model, double deviation_digits, const char* note) {
  model.deviation_digits = deviation_digits;
  model.note = note;
  return model;
}

constexpr NistModel OfLogResponse(NistModel model, int predictors) {
  model.log_response = true;
  model.predictors = predictors;
  return model;
}

constexpr NistModel kModels[] = {
    Of("Bennett5", 3, [](auto b, auto x) { return b[0] * pow(b[1] + x[0], -1.0 / b[2]); }),
    Of("BoxBOD", 2, kSaturation),
    Of("Chwirut1", 3, kChwirut),
    Of("Chwirut2", 3, kChwirut),
    Of("DanWood", 2, [](auto b, auto x) { return b[0] * exp(b[1] * log(x[0])); }),
    Of("ENSO", 9, kEnso),
    Of("Eckerle4", 3,
       [](auto b, auto x) {
         const auto s = (x[0] - b[2]) / b[1];
         return b[0] / b[1] * exp(-0.5 * s * s);
       }),
    Of("Gauss1", 8, kGauss),
    Of("Gauss2", 8, kGauss),
    Of("Gauss3", 8, kGauss),
    Of("Hahn1", 7, kCubicByCubic),
    Of("Kirby2", 5,
       [](auto b, auto x) { return (b[0] + x[0] * (b[1] + x[0] * b[2])) / (1.0 + x[0] * (b[3] + x[0] * b[4])); }),
    WithNote(Of("Lanczos1", 6, kLanczos), 2,
             "its residual standard deviation, 8.9e-14, is at the level of rounding of its data: about 3 digits of the "
             "standard deviations are all that doubles can give"),
    Of("Lanczos2", 6, kLanczos),
    Of("Lanczos3", 6, kLanczos),
    Of("MGH09", 4,
       [](auto b, auto x) { return b[0] * (x[0] * x[0] + x[0] * b[1]) / (x[0] * x[0] + x[0] * b[2] + b[3]); }),
    Of("MGH10", 3, [](auto b, auto x) { return b[0] * exp(b[1] / (x[0] + b[2])); }),
    Of("MGH17", 5, [](auto b, auto x) { return b[0] + b[1] * exp(-x[0] * b[3]) + b[2] * exp(-x[0] * b[4]); }),
    Of("Misra1a", 2, kSaturation),
    Of("Misra1b", 2, [](auto b, auto x) { return b[0] * (1.0 - pow(1.0 + b[1] * x[0] / 2.0, -2.0)); }),
    Of("Misra1c", 2, [](auto b, auto x) { return b[0] * (1.0 - pow(1.0 + 2.0 * b[1] * x[0], -0.5)); }),
    Of("Misra1d", 2, [](auto b, auto x) { return b[0] * b[1] * x[0] / (1.0 + b[1] * x[0]); }),
    OfLogResponse(Of("Nelson", 3, [](auto b, auto x) { return b[0] - b[1] * x[0] * exp(-b[2] * x[1]); }), 2),
    Of("Rat42", 3, [](auto b, auto x) { return b[0] / (1.0 + exp(b[1] - b[2] * x[0])); }),
    Of("Rat43", 4, [](auto b, auto x) { return b[0] / pow(1.0 + exp(b[1] - b[2] * x[0]), 1.0 / b[3]); }),
    Of("Roszman1", 4,
       [](auto b, auto x) { return b[0] - b[1] * x[0] - atan(b[2] / (x[0] - b[3])) / std::numbers::pi; }),
    Of("Thurber", 7, kCubicByCubic),
};

constexpr double kValueDigits = 8;
constexpr int kMaxIterations = 1000;  // the curved valley of Bennett5 takes 270

struct Misprint {
  const char *data, *printed, *meant;
};
constexpr Misprint kMisprints[] = {{"Roszman1", "1.20196866396E-0", "2.0196866396E-01"}};

using Lines = std::vector<std::string>;

Result<Lines> ReadLines(const std::filesystem::path& file) {
  SCANCAL_ASSIGN_OR_RETURN(TextLines text, TextLines::Open(file));
  Lines lines;
  while (true) {
    SCANCAL_ASSIGN_OR_RETURN(const std::optional<std::string_view> line, text.TakeLine());
    if (!line) return lines;
    lines.emplace_back(WithoutBlanks(*line));
  }
}

struct Section {
  size_t first = 0, last = 0;  // lines, from 1
};

// "Starting Values   (lines 41 to 43)" in the header.
Result<Section> FindSection(const std::string& file, const Lines& lines, const std::string& name) {
  static const std::regex range(R"(\(lines +(\d{1,6}) +to +(\d{1,6})\))");
  std::smatch match;
  const auto found = std::find_if(lines.begin(), lines.end(), [&](const std::string& line) {
    return line.find(name) != std::string::npos && std::regex_search(line, match, range);
  });
  if (found == lines.end())
    return Error{file + ": found no \"" + name +
                 " (lines ... to ...)\", expected a file of NIST's certified regressions"};
  const Section section{std::stoul(match[1]), std::stoul(match[2])};
  if (section.first < 1 || section.first > section.last || section.last > lines.size())
    return Error{file + ": found " + std::to_string(lines.size()) + " lines, expected " + name + " in lines " +
                 match[1].str() + " to " + match[2].str()};
  return section;
}

std::vector<std::string> Words(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

Error WrongLine(const std::string& file, const Lines& lines, size_t number, const std::string& expected) {
  return Error{file + ":" + std::to_string(number) + ": found " + Quoted(lines[number - 1]) + ", expected " + expected};
}

void CorrectMisprint(const NistModel& model, std::string* certified, std::string* note) {
  for (const Misprint& misprint : kMisprints) {
    if (misprint.data != std::string(model.name) || misprint.printed != *certified) continue;
    *certified = misprint.meant;
    *note = std::string("its file misprints ") + misprint.meant + " as " + misprint.printed;
  }
}

// "b1 =   -2000       -1500        -2.5235058043E+03  2.9715175411E+02": start 1, start 2, certified, its deviation.
Result<void> ReadParameters(const std::string& file, const Lines& lines, const NistModel& model, NistData* data) {
  SCANCAL_ASSIGN_OR_RETURN(const Section section, FindSection(file, lines, "Starting Values"));
  if (section.last - section.first + 1 != static_cast<size_t>(model.parameters))
    return Error{file + ": found starting values in lines " + std::to_string(section.first) + " to " +
                 std::to_string(section.last) + ", expected " + std::to_string(model.parameters) + " parameters"};
  for (size_t number = section.first; number <= section.last; ++number) {
    const std::string name = "b" + std::to_string(number - section.first + 1);
    std::vector<std::string> words = Words(lines[number - 1]);
    const Error wrong = WrongLine(file, lines, number, name + " = two starts, certified value, standard deviation");
    if (words.size() != 6 || words[0] != name || words[1] != "=") return wrong;
    CorrectMisprint(model, &words[4], &data->note);
    const ParsedNumber start = ParseNumber(words[3]);
    if (start.kind != NumberKind::kNumber || !ParseKnown(words[4]) || !ParseKnown(words[5])) return wrong;
    data->start.push_back(start.value);
    data->values.push_back(words[4]);
    data->deviations.push_back(words[5]);
  }
  return {};
}

Result<void> ReadObservations(const std::string& file, const Lines& lines, const NistModel& model, NistData* data) {
  SCANCAL_ASSIGN_OR_RETURN(const Section section, FindSection(file, lines, "Data"));
  const size_t columns = 1 + static_cast<size_t>(model.predictors);
  for (size_t number = section.first; number <= section.last; ++number) {
    const std::vector<std::string> words = Words(lines[number - 1]);
    const Error wrong = WrongLine(file, lines, number, std::to_string(columns) + " numbers");
    if (words.size() != columns) return wrong;
    double cells[3] = {};
    for (size_t k = 0; k < columns; ++k) {
      const ParsedNumber number_in_cell = ParseNumber(words[k]);
      if (number_in_cell.kind != NumberKind::kNumber) return wrong;
      cells[k] = number_in_cell.value;
    }
    data->observations.push_back({model.log_response ? std::log(cells[0]) : cells[0], {cells[1], cells[2]}});
  }
  return {};
}

}  // namespace

std::span<const NistModel> NistModels() { return kModels; }

Result<NistData> ReadNist(const std::filesystem::path& file, const NistModel& model) {
  SCANCAL_ASSIGN_OR_RETURN(const Lines lines, ReadLines(file));
  NistData data;
  for (const std::string& line : lines) {
    const size_t found = line.find(" Level of Difficulty");
    if (found != std::string::npos) data.level = line.substr(0, found);
  }
  SCANCAL_RETURN_IF_ERROR(ReadParameters(file.string(), lines, model, &data));
  SCANCAL_RETURN_IF_ERROR(ReadObservations(file.string(), lines, model, &data));
  return data;
}

SelftestRow Check(const NistModel& model, const NistData& data) {
  const LeastSquares solved = SolveLeastSquares(model.pose(data.start, data.observations), {kMaxIterations});
  const Eigen::VectorXd u = solved.covariance.matrix.diagonal().cwiseSqrt();
  return {.name = model.name,
          .level = data.level,
          .observations = static_cast<int>(data.observations.size()),
          .parameters = model.parameters,
          .values = Compare(solved.fit.estimate.system, data.values, kValueDigits),
          .deviations = Compare(u, data.deviations, model.deviation_digits),
          .iterations = solved.fit.iterations,
          .note = data.note + (*model.note ? model.note : solved.fit.message.english)};
}

}  // namespace scancal::selftest
