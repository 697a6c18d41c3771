#include "models/turntable/range_image.h"
#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include "models/median.h"

namespace scancal::turntable {
namespace {

constexpr double kCellsPerPoint = 50;       // an image with fewer points is none
constexpr double kFewestCells = 1'000'000;  // below which nobody minds
constexpr double kTurnAround = 0.05;        // of all angles: less is no sweep back
constexpr double kBackAlongLine = 0.5;      // of all places along the line: a jump back by more begins a profile

// Where the angle stays and the place along the line jumps back, a profile begins, unless points are in no order.
std::vector<char> BeginningsOfRows(const std::vector<char>& angle_changes, const std::vector<double>& across) {
  constexpr size_t kFewestInRow = 8;
  const auto [low, high] = std::minmax_element(across.begin(), across.end());
  const double jump = kBackAlongLine * (*high - *low);
  std::vector<char> begins = angle_changes;
  size_t rows = 0, way = 0;  // 1: places grow along the line, 2: they fall
  for (size_t i = 1; i < across.size(); ++i) {
    const double step = across[i] - across[i - 1];
    if (!begins[i] && way == 0 && step != 0) way = step > 0 ? 1 : 2;
    if (!begins[i] && way != 0 && (way == 1 ? -step : step) > jump) begins[i] = 1;
    rows += static_cast<size_t>(begins[i]);
  }
  return rows * kFewestInRow <= across.size() ? begins : angle_changes;
}

// Steps that most rows have between neighbours: where a quarter of the points is missing, still that of the others.
double PitchOf(const std::vector<double>& across, const std::vector<int32_t>& row) {
  std::vector<double> steps;
  const size_t every = across.size() / 1'000'000 + 1;
  for (size_t i = 1; i < across.size(); ++i)
    if (row[i] == row[i - 1] && across[i] != across[i - 1] && i % every == 0)
      steps.push_back(std::abs(across[i] - across[i - 1]));
  if (steps.empty()) return 0;
  const auto at = steps.begin() + static_cast<std::ptrdiff_t>(3 * steps.size() / 4);
  std::nth_element(steps.begin(), at, steps.end());
  return *at;
}

// Rows between turning points of the angle, which come back by more than kTurnAround of the whole.
std::vector<std::pair<int32_t, int32_t>> SweepsOf(const std::vector<double>& alpha) {
  const auto [low, high] = std::minmax_element(alpha.begin(), alpha.end());
  const double back = kTurnAround * (*high - *low);
  std::vector<int32_t> turns = {0};
  int32_t top = 0, bottom = 0;
  int way = 0;
  for (int32_t k = 1; k < std::ssize(alpha); ++k) {
    const auto at = [&](int32_t r) { return alpha[static_cast<size_t>(r)]; };
    if (at(k) > at(top)) top = k;
    if (at(k) < at(bottom)) bottom = k;
    if (way >= 0 && at(top) - at(k) > back) {
      if (way > 0) turns.push_back(top);
      way = -1;
      bottom = k;
    } else if (way <= 0 && at(k) - at(bottom) > back) {
      if (way < 0) turns.push_back(bottom);
      way = 1;
      top = k;
    }
  }
  turns.push_back(static_cast<int32_t>(alpha.size()));
  std::vector<std::pair<int32_t, int32_t>> sweeps;
  for (size_t k = 1; k < turns.size(); ++k)
    if (turns[k] - turns[k - 1] >= kFewestRows) sweeps.emplace_back(turns[k - 1], turns[k]);
  return sweeps;
}

// Rows in the order of their keys.
void SortRows(const std::map<double, int32_t>& row_of_key, RangeImage* image) {
  std::vector<int32_t> to(row_of_key.size());
  std::vector<double> alpha;
  for (const auto& [key, row] : row_of_key) {
    to[static_cast<size_t>(row)] = static_cast<int32_t>(alpha.size());
    alpha.push_back(image->alpha[static_cast<size_t>(row)]);
  }
  image->alpha = std::move(alpha);
  for (int32_t& row : image->row) row = to[static_cast<size_t>(row)];
}

}  // namespace

void PointsChecksum::Add(const ScanBatch& batch) {
  constexpr uint64_t kPrime = 0x100000001b3;
  std::vector<const double*> columns;
  for (const char* name : {"angle", "y", "z", "bearing", "range"})
    if (const int k = batch.Find(name); k >= 0) columns.push_back(batch.columns[static_cast<size_t>(k)].data());
  for (size_t i = 0; i < batch.size(); ++i) {
    for (const double* column : columns) {
      hash_ = (hash_ ^ std::bit_cast<uint64_t>(column[i])) * kPrime;
      hash_ ^= hash_ >> 29;  // FNV carries nothing down, and round numbers have their digits above
    }
  }
  points_ += static_cast<int64_t>(batch.size());
}

std::string PointsChecksum::Text() const { return fmt::format("{:016x}", hash_); }

Result<void> MakeImage(const std::vector<double>& across, const std::string& file, RangeImage* image) {
  const auto [low, high] = std::minmax_element(across.begin(), across.end());
  image->rows = static_cast<int32_t>(image->alpha.size());
  image->pitch = PitchOf(across, image->row);
  if (!(image->pitch > 0) || image->rows < kFewestRows)
    return Error{
        fmt::format("{}: target {}: found {} profiles{}, expected a scan of at least {} profiles with several "
                    "points each",
                    file, image->name, image->rows, image->pitch > 0 ? "" : " of single points", kFewestRows)};
  image->first_across = *low;
  const double columns = std::floor((*high - *low) / image->pitch + 0.5) + 1;
  const double cells = columns * image->rows;
  if (cells > std::max(kFewestCells, kCellsPerPoint * static_cast<double>(across.size())))
    return Error{
        fmt::format("{}: target {}: its {} points lie too far apart for an image of {} profiles by {:.0f} "
                    "places along the line; leave stray ones out with keep:",
                    file, image->name, across.size(), image->rows, columns)};
  image->columns = static_cast<int32_t>(columns);
  image->column.resize(across.size());
  image->point.assign(static_cast<size_t>(cells), -1);
  for (size_t i = 0; i < across.size(); ++i) {
    image->column[i] = static_cast<int32_t>(std::floor((across[i] - *low) / image->pitch + 0.5));
    int32_t& cell = image->point[static_cast<size_t>(image->row[i]) * static_cast<size_t>(image->columns) +
                                 static_cast<size_t>(image->column[i])];
    if (cell < 0) cell = static_cast<int32_t>(i);
  }
  for (size_t k = 1; k < image->alpha.size(); ++k)
    image->alpha[k] -= kTurn_rad * std::round((image->alpha[k] - image->alpha[k - 1]) / kTurn_rad);
  image->sweeps = SweepsOf(image->alpha);
  return {};
}

Result<RangeImage> ReadRangeImage(const ScanDeclaration& scan, const Senses& senses, int64_t most,
                                  const std::function<void(double)>& progress) {
  SCANCAL_ASSIGN_OR_RETURN(const auto reader, ScanReader::Open(scan.format));
  const std::string file = scan.format.path.string();
  if (reader->gives_heights() && !senses.depth_declared) return HeightsWithoutSense(scan);
  RangeImage image;
  image.name = scan.name;
  std::vector<double> alpha, across;
  std::map<double, int32_t> row_of_key;
  bool keyed = false;
  PointsChecksum checksum;
  ScanBatch batch;
  SensorColumns points;
  for (;;) {
    SCANCAL_ASSIGN_OR_RETURN(const bool more, reader->Next(&batch));
    if (!more) break;
    ToSensor(senses, batch, &points);
    SCANCAL_ASSIGN_OR_RETURN(const std::vector<char> kept, Kept(scan, batch, points));
    const int profile = batch.Find("profile"), bearing = batch.Find("bearing");
    image.lidar = !points.range.empty();
    keyed = profile >= 0;
    for (size_t i = 0; i < batch.size(); ++i) {
      if (!kept[i]) continue;
      image.y.push_back(points.y[i]);
      image.z.push_back(points.z[i]);
      image.number.push_back(checksum.points() + static_cast<int64_t>(i) + 1);
      across.push_back(image.lidar ? batch.columns[static_cast<size_t>(bearing)][i] : points.z[i]);
      if (keyed) {
        const auto [found, fresh] = row_of_key.try_emplace(batch.columns[static_cast<size_t>(profile)][i],
                                                           static_cast<int32_t>(row_of_key.size()));
        if (fresh) image.alpha.push_back(points.alpha[i]);
        image.row.push_back(found->second);
      } else {
        alpha.push_back(points.alpha[i]);
      }
    }
    checksum.Add(batch);
    if (std::ssize(image.y) > most)
      return Error{
          fmt::format("{}: target {}: planes are looked for among at most {} points at once, found more; leave "
                      "points out with keep:, or write a scan with fewer",
                      file, scan.name, RangeImage::kMostPoints)};
    progress(static_cast<double>(reader->bytes_read()) /
             static_cast<double>(std::max<int64_t>(1, reader->bytes_total())));
  }
  if (image.y.empty()) return Error{file + ": target " + scan.name + ": no point is left; widen its keep: intervals"};
  if (keyed) {
    SortRows(row_of_key, &image);
  } else {
    std::vector<char> begins(alpha.size(), 0);
    for (size_t i = 1; i < alpha.size(); ++i) begins[i] = static_cast<char>(alpha[i] != alpha[i - 1]);
    begins = BeginningsOfRows(begins, across);
    for (size_t i = 0; i < alpha.size(); ++i) {
      if (i == 0 || begins[i]) image.alpha.push_back(alpha[i]);
      image.row.push_back(static_cast<int32_t>(image.alpha.size()) - 1);
    }
  }
  image.points_in_file = checksum.points();
  image.checksum = checksum.Text();
  SCANCAL_RETURN_IF_ERROR(MakeImage(across, file, &image));
  return image;
}

}  // namespace scancal::turntable
