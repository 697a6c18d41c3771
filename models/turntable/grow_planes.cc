#include "models/turntable/grow_planes.h"
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include "models/median.h"
#include "models/turntable/regions.h"
#include "solver/dense.h"

namespace scancal::turntable {
namespace {

constexpr double kTolerance = 4;          // sigma
constexpr double kRougher = 2;            // than its seed, and the plane ends there
constexpr double kRoughestSeed = 6;       // of the noise between neighbours
constexpr double kSeedSide = 10;          // of a block, in noise
constexpr int32_t kFewestOfSide = 6;      // cells of a block
constexpr double kFilled = 0.45;          // of a block
constexpr double kLeastCosine = 0.26;     // within 15 degrees of edge-on
constexpr double kNoDepth = 0.03;         // cosine below which depth says nothing
constexpr size_t kFewestOfPlane = 200;    // of a plane, after erosion
constexpr double kFewestOfImage = 0.002;  // of all points
constexpr size_t kSmallestPiece = 20;     // of a plane that erosion has cut in pieces
constexpr int32_t kFewestColumns = 5;     // of a plane
constexpr int32_t kErosion = 2;           // cells
constexpr int32_t kMostErosion = 20;      // rows, where they are closer than cells of a line
constexpr int32_t kNeighbours = 8;        // cells between regions that may be one
constexpr size_t kFitted = 20'000;        // cells that a fit looks at
constexpr int kGrowths = 25;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct TiltedPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();
  double distance = 0;
  double dM = 0, dN = 0;  // by which M and N differ here, mm
};

struct Grown {
  TiltedPlane plane;
  std::vector<int32_t> cells;  // ascending
  double sigma = 0;
};

struct SeedBlock {
  double rms = 0;
  int32_t row = 0, column = 0;  // of its corner
  TiltedPlane plane;
};

class Grower {
 public:
  Grower(const RangeImage& image, size_t sweep, const System& system, const std::array<double, 2>& slack)
      : image_(image),
        first_row_(image.sweeps[sweep].first),
        rows_(image.sweeps[sweep].second - image.sweeps[sweep].first),
        columns_(image.columns),
        grid_{rows_, columns_},
        slack_(slack),
        terms_(static_cast<size_t>(rows_)),
        owner_(static_cast<size_t>(rows_) * static_cast<size_t>(columns_), 0),
        stamp_(owner_.size(), 0) {
    for (int32_t r = 0; r < rows_; ++r) {
      const ProfileInTable<double> at = system.At(image.alpha[static_cast<size_t>(first_row_ + r)]);
      at_.push_back({at.Turned(at.origin), at.Turned(at.along_y), at.Turned(at.along_z), at.Turned({-1, 0, 0}),
                     at.Turned({0, 1, 0})});
    }
  }

  GrownPlanes Grow() {
    Measure();
    std::vector<SeedBlock> seeds = Seeds();
    std::vector<char> tried(seeds.size(), 0);
    std::vector<int32_t> seed_of(owner_.size(), -1);  // by a block's corner
    for (size_t k = 0; k < seeds.size(); ++k) seed_of[Cell(seeds[k].row, seeds[k].column)] = static_cast<int32_t>(k);
    for (size_t k = 0; k < seeds.size(); ++k) {
      if (tried[k]) continue;
      Grown grown;
      if (!GrowFrom(seeds[k], &grown)) continue;
      // Whatever becomes of it, blocks that belong to it would only lead here again.
      std::vector<size_t> of_block(seeds.size(), 0);
      for (const int32_t cell : grown.cells) {
        const int32_t r = cell / columns_, c = cell % columns_;
        const int32_t seed = seed_of[Cell(r - r % block_rows_, c - c % block_columns_)];
        if (seed >= 0 && ++of_block[static_cast<size_t>(seed)] * 2 >
                             static_cast<size_t>(block_rows_) * static_cast<size_t>(block_columns_))
          tried[static_cast<size_t>(seed)] = 1;
      }
      if (InnerCells(grown).empty()) continue;
      if (Cosine(grown) < kLeastCosine) {
        ++result_.edge_on;
        continue;
      }
      if (IsBent(grid_, grown.cells, OffOf(grown), grown.sigma)) {
        ++result_.bent;
        continue;
      }
      regions_.push_back(std::move(grown));
      for (const int32_t cell : regions_.back().cells)
        owner_[static_cast<size_t>(cell)] = static_cast<int32_t>(regions_.size());
    }
    MergeNeighbours();
    Finish();
    return std::move(result_);
  }

 private:
  struct RowInTable {
    Eigen::Vector3d origin, along_y, along_z, by_M, by_N;
  };

  size_t Cell(int32_t r, int32_t c) const {
    return static_cast<size_t>(r) * static_cast<size_t>(columns_) + static_cast<size_t>(c);
  }
  int32_t PointOf(int32_t cell) const { return image_.point[Cell(first_row_, 0) + static_cast<size_t>(cell)]; }
  double Y(int32_t p) const { return image_.y[static_cast<size_t>(p)]; }
  double Z(int32_t p) const { return image_.z[static_cast<size_t>(p)]; }
  double DepthOf(int32_t p) const { return image_.lidar ? std::hypot(Y(p), Z(p)) : Y(p); }
  size_t Fewest() const {
    return std::max(kFewestOfPlane, static_cast<size_t>(kFewestOfImage * static_cast<double>(image_.y.size())));
  }
  Eigen::Vector3d PlaceOf(int32_t r, int32_t p) const {
    const RowInTable& at = at_[static_cast<size_t>(r)];
    return at.origin + at.along_y * Y(p) + at.along_z * Z(p);
  }

  // Makes `plane` the one that Off and Slope speak of.
  void Look(const TiltedPlane& plane) {
    for (size_t r = 0; r < at_.size(); ++r) {
      const RowInTable& at = at_[r];
      terms_[r] = {plane.normal.dot(at.origin + plane.dM * at.by_M + plane.dN * at.by_N) - plane.distance,
                   plane.normal.dot(at.along_y), plane.normal.dot(at.along_z)};
    }
  }
  // n . dP/ddepth.
  double Slope(int32_t r, int32_t p) const {
    const std::array<double, 3>& t = terms_[static_cast<size_t>(r)];
    return image_.lidar ? (t[1] * Y(p) + t[2] * Z(p)) / std::max(DepthOf(p), 1e-9) : t[1];
  }
  // Of a point from the plane, along depth.
  double Off(int32_t r, int32_t p) const {
    const std::array<double, 3>& t = terms_[static_cast<size_t>(r)];
    const double slope = Slope(r, p);
    return std::abs(slope) < kNoDepth ? kInfinity : (t[0] + t[1] * Y(p) + t[2] * Z(p)) / slope;
  }
  double OffCell(int32_t cell) const { return Off(cell / columns_, PointOf(cell)); }

  double SigmaOf(const std::vector<int32_t>& cells) const {
    std::vector<double> off;
    const size_t every = cells.size() / kFitted + 1;
    for (size_t k = 0; k < cells.size(); k += every) off.push_back(std::abs(OffCell(cells[k])));
    return std::max(least_sigma_, kMadToSigma * Median(std::move(off)));
  }

  // Noise of depth between neighbours, along the line and from row to row, and how far apart they are across the sight.
  void Measure() {
    std::vector<double> along, down, step_c, step_r;
    const size_t every = owner_.size() / 300'000 + 1;
    for (size_t k = 0; k < owner_.size(); k += every) {
      const auto cell = static_cast<int32_t>(k);
      const int32_t r = cell / columns_, c = cell % columns_, p = PointOf(cell);
      if (p < 0) continue;
      const auto look = [&](bool inside, int32_t by, std::vector<double>* bends, std::vector<double>* steps) {
        if (!inside || PointOf(cell - by) < 0 || PointOf(cell + by) < 0) return;
        bends->push_back(std::abs(DepthOf(PointOf(cell - by)) - 2 * DepthOf(p) + DepthOf(PointOf(cell + by))));
        const Eigen::Vector3d step = PlaceOf((cell + by) / columns_, PointOf(cell + by)) - PlaceOf(r, p);
        const RowInTable& at = at_[static_cast<size_t>(r)];
        const Eigen::Vector3d sight =
            image_.lidar ? Eigen::Vector3d((at.along_y * Y(p) + at.along_z * Z(p)).normalized()) : at.along_y;
        steps->push_back((step - sight * sight.dot(step)).norm());
      };
      look(c > 0 && c + 1 < columns_, 1, &along, &step_c);
      look(r > 0 && r + 1 < rows_, columns_, &down, &step_r);
    }
    const double spacing_c = std::max(Median(step_c), 1e-6), spacing_r = std::max(Median(step_r), 1e-6);
    least_sigma_ = 1e-4 * spacing_c;
    noise_ = std::max(least_sigma_, kMadToSigma * std::max(Median(along), Median(down)) / std::sqrt(6.0));
    const auto side = [&](double spacing, int32_t cells) {
      const double wanted = std::ceil(kSeedSide * noise_ / spacing);
      return static_cast<int32_t>(std::clamp<double>(wanted, kFewestOfSide, std::max(kFewestOfSide, cells / 6)));
    };
    block_rows_ = side(spacing_r, rows_);
    block_columns_ = side(spacing_c, columns_);
    const bool coarse = std::min(rows_, columns_) < 60;
    erosion_columns_ = coarse ? 1 : kErosion;
    erosion_rows_ = static_cast<int32_t>(
        std::clamp<double>(std::round(erosion_columns_ * spacing_c / spacing_r), erosion_columns_, kMostErosion));
  }

  std::vector<SeedBlock> Seeds() {
    std::vector<SeedBlock> seeds;
    for (int32_t r = 0; r < rows_; r += block_rows_) {
      for (int32_t c = 0; c < columns_; c += block_columns_) {
        SeedBlock seed{0, r, c, {}};
        const std::vector<int32_t> cells = Block(seed);
        if (static_cast<double>(cells.size()) < kFilled * block_rows_ * block_columns_) continue;
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        for (const int32_t cell : cells)
          mean += PlaceOf(cell / columns_, PointOf(cell)) / static_cast<double>(cells.size());
        Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
        for (const int32_t cell : cells) {
          const Eigen::Vector3d p = PlaceOf(cell / columns_, PointOf(cell)) - mean;
          spread += p * p.transpose();
        }
        seed.plane.normal = EigenOf(spread).vectors.col(0);
        seed.plane.distance = seed.plane.normal.dot(mean);
        for (int k = 0; k < 2; ++k) Fit(cells, noise_, /*own_mount=*/false, &seed.plane);
        Look(seed.plane);
        double squares = 0;
        for (const int32_t cell : cells) squares += OffCell(cell) * OffCell(cell);
        seed.rms = std::sqrt(squares / static_cast<double>(cells.size() - 3));
        if (seed.rms < kRoughestSeed * noise_) seeds.push_back(seed);
      }
    }
    std::stable_sort(seeds.begin(), seeds.end(), [](const auto& a, const auto& b) { return a.rms < b.rms; });
    return seeds;
  }

  // Its cells that have a point and no owner.
  std::vector<int32_t> Block(const SeedBlock& seed) const {
    std::vector<int32_t> cells;
    for (int32_t r = seed.row; r < std::min(rows_, seed.row + block_rows_); ++r)
      for (int32_t c = seed.column; c < std::min(columns_, seed.column + block_columns_); ++c)
        if (const auto cell = static_cast<int32_t>(Cell(r, c)); owner_[Cell(r, c)] == 0 && PointOf(cell) >= 0)
          cells.push_back(cell);
    return cells;
  }

  // One step of least squares by depth: normal, distance and, with the slack as their prior, the mount.
  void Fit(const std::vector<int32_t>& cells, double sigma, bool own_mount, TiltedPlane* plane) {
    Look(*plane);
    const size_t every = cells.size() / kFitted + 1;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double count = 0;
    for (size_t k = 0; k < cells.size(); k += every, ++count) centre += PlaceOf(cells[k] / columns_, PointOf(cells[k]));
    centre /= count;
    const Eigen::Vector3d e1 = plane->normal.unitOrthogonal(), e2 = plane->normal.cross(e1);
    double size = 0;
    for (size_t k = 0; k < cells.size(); k += every)
      size += (PlaceOf(cells[k] / columns_, PointOf(cells[k])) - centre).squaredNorm();
    size = std::max(std::sqrt(size / count), 1e-9);
    const int unknowns = own_mount ? 5 : 3;
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(unknowns, unknowns), b = Eigen::MatrixXd::Zero(unknowns, 1);
    for (size_t k = 0; k < cells.size(); k += every) {
      const int32_t r = cells[k] / columns_, p = PointOf(cells[k]);
      const double off = Off(r, p), slope = Slope(r, p);
      if (!std::isfinite(off)) continue;
      const RowInTable& at = at_[static_cast<size_t>(r)];
      const Eigen::Vector3d from = (PlaceOf(r, p) - centre) / size;
      Eigen::Matrix<double, 5, 1> row;
      row << e1.dot(from), e2.dot(from), -1, plane->normal.dot(at.by_M), plane->normal.dot(at.by_N);
      row /= slope;
      A.noalias() += row.head(unknowns) * row.head(unknowns).transpose();
      b.noalias() -= row.head(unknowns) * off;
    }
    if (own_mount) {
      for (const int k : {0, 1}) {
        const double weight =
            slack_[static_cast<size_t>(k)] > 0 ? std::pow(sigma / slack_[static_cast<size_t>(k)], 2) : 1e12;
        A(3 + k, 3 + k) += weight;
        b(3 + k, 0) -= weight * (k == 0 ? plane->dM : plane->dN);
      }
    }
    const Eigen::MatrixXd x = LeastSquares(A, b);
    const Eigen::Vector3d turn = (x(0, 0) * e1 + x(1, 0) * e2) / size;
    const double longer = (plane->normal + turn).norm();
    plane->distance = (plane->distance + turn.dot(centre) + x(2, 0)) / longer;
    plane->normal = (plane->normal + turn) / longer;
    if (!own_mount) return;
    plane->dM += x(3, 0);
    plane->dN += x(4, 0);
  }
  bool OwnMount() const { return slack_[0] > 0 || slack_[1] > 0; }

  // Cells without an owner that hang together with `from`, within the tolerance of the plane that is looked at.
  std::vector<int32_t> Flood(const std::vector<int32_t>& from, double tolerance) {
    ++stamped_;
    std::vector<int32_t> cells;
    const auto add = [&](int32_t r, int32_t c) {
      if (r < 0 || c < 0 || r >= rows_ || c >= columns_) return;
      const size_t cell = Cell(r, c);
      if (stamp_[cell] == stamped_ || owner_[cell] != 0) return;
      stamp_[cell] = stamped_;
      const int32_t p = PointOf(static_cast<int32_t>(cell));
      if (p >= 0 && std::abs(Off(r, p)) < tolerance) cells.push_back(static_cast<int32_t>(cell));
    };
    for (const int32_t cell : from) add(cell / columns_, cell % columns_);
    for (size_t k = 0; k < cells.size(); ++k) {
      const int32_t r = cells[k] / columns_, c = cells[k] % columns_;
      for (int32_t dr = -1; dr <= 1; ++dr)
        for (int32_t dc = -1; dc <= 1; ++dc) add(r + dr, c + dc);
      for (const int32_t two : {-2, 2}) {
        add(r + two, c);
        add(r, c + two);
      }
    }
    std::sort(cells.begin(), cells.end());
    return cells;
  }

  bool GrowFrom(const SeedBlock& seed, Grown* grown) {
    const std::vector<int32_t> block = Block(seed);
    if (static_cast<double>(block.size()) < kFilled * block_rows_ * block_columns_) return false;
    grown->plane = seed.plane;
    const double most = kRougher * std::max(seed.rms, least_sigma_);
    grown->sigma = std::max(seed.rms, least_sigma_);
    size_t before = 0;
    for (int k = 0; k < kGrowths; ++k) {
      Look(grown->plane);
      grown->cells = Flood(block, kTolerance * grown->sigma);
      if (grown->cells.size() * 2 < block.size()) return false;
      const size_t change = std::max(before, grown->cells.size()) - std::min(before, grown->cells.size());
      if (k > 2 && change * 1000 <= before) break;
      before = grown->cells.size();
      Refit(grown);
      grown->sigma = std::min(grown->sigma, most);
    }
    DropOffBlocks(grid_, OffOf(*grown), grown->sigma, &grown->cells);
    if (grown->cells.size() < Fewest()) return false;
    Refit(grown);
    grown->sigma = std::min(grown->sigma, most);  // two surfaces are no rough one
    return true;
  }

  void Refit(Grown* grown) {
    for (int k = 0; k < 2; ++k) Fit(grown->cells, grown->sigma, OwnMount(), &grown->plane);
    Look(grown->plane);
    grown->sigma = SigmaOf(grown->cells);
  }

  std::vector<double> OffOf(const Grown& grown) {
    Look(grown.plane);
    std::vector<double> off;
    for (const int32_t cell : grown.cells) off.push_back(OffCell(cell));
    return off;
  }
  // Its cells away from edges, without what edges have cut off.
  std::vector<int32_t> InnerCells(const Grown& grown) const {
    return WithoutFragments(grid_, Eroded(grid_, grown.cells, erosion_rows_, erosion_columns_),
                            std::max(Fewest(), grown.cells.size() / kSmallestPiece));
  }

  double Cosine(const Grown& grown) {
    Look(grown.plane);
    std::vector<double> slopes;
    for (const int32_t cell : grown.cells) slopes.push_back(std::abs(Slope(cell / columns_, PointOf(cell))));
    return Median(std::move(slopes));
  }

  void MergeNeighbours() {
    const int32_t gap = std::max(kNeighbours, erosion_rows_ * 2);
    for (size_t a = 0; a < regions_.size(); ++a) {
      for (size_t b = a + 1; b < regions_.size();) {
        Grown both = regions_[a];
        const double sigma = std::max(regions_[a].sigma, regions_[b].sigma);
        const bool alike = std::abs(regions_[a].plane.normal.dot(regions_[b].plane.normal)) > 0.99;
        if (alike && AreNear(grid_, regions_[a].cells, regions_[b].cells, gap)) {
          both.cells.insert(both.cells.end(), regions_[b].cells.begin(), regions_[b].cells.end());
          std::sort(both.cells.begin(), both.cells.end());
          for (int k = 0; k < 3; ++k) Refit(&both);
          if (both.sigma < 1.1 * sigma && !IsBent(grid_, both.cells, OffOf(both), both.sigma)) {
            regions_[a] = std::move(both);
            regions_.erase(regions_.begin() + static_cast<std::ptrdiff_t>(b));
            b = a + 1;
            continue;
          }
        }
        ++b;
      }
    }
  }

  void Finish() {
    std::fill(owner_.begin(), owner_.end(), 0);
    std::vector<GrownPlane> planes(regions_.size());
    for (size_t k = 0; k < regions_.size(); ++k) {
      planes[k].normal = regions_[k].plane.normal;
      planes[k].distance = regions_[k].plane.distance;
      planes[k].sigma = regions_[k].sigma;
      planes[k].cosine = Cosine(regions_[k]);
      for (const int32_t cell : InnerCells(regions_[k]))
        owner_[static_cast<size_t>(cell)] = static_cast<int32_t>(k) + 1;
    }
    for (int32_t p = 0; p < std::ssize(image_.y); ++p) {
      const int32_t r = image_.row[static_cast<size_t>(p)] - first_row_;
      if (r < 0 || r >= rows_) continue;
      const size_t cell = Cell(r, image_.column[static_cast<size_t>(p)]);
      if (owner_[cell] != 0) planes[static_cast<size_t>(owner_[cell]) - 1].points.push_back(p);
    }
    for (size_t k = 0; k < planes.size(); ++k) {
      Look(regions_[k].plane);
      const auto off = [&](int32_t p) { return Off(image_.row[static_cast<size_t>(p)] - first_row_, p); };
      // Of several points in a cell one was asked.
      std::erase_if(planes[k].points, [&](int32_t p) { return !(std::abs(off(p)) < kTolerance * planes[k].sigma); });
      double squares = 0;
      for (const int32_t p : planes[k].points) squares += off(p) * off(p);
      planes[k].rms = std::sqrt(squares / std::max<double>(1, static_cast<double>(planes[k].points.size())));
      int32_t left = columns_, right = -1, top = rows_, bottom = -1;
      for (const int32_t p : planes[k].points) {
        left = std::min(left, image_.column[static_cast<size_t>(p)]);
        right = std::max(right, image_.column[static_cast<size_t>(p)]);
        top = std::min(top, image_.row[static_cast<size_t>(p)] - first_row_);
        bottom = std::max(bottom, image_.row[static_cast<size_t>(p)] - first_row_);
      }
      if (planes[k].points.size() >= Fewest() && right - left + 1 >= kFewestColumns &&
          bottom - top + 1 >= kFewestRows / 2)
        result_.planes.push_back(std::move(planes[k]));
    }
  }

  const RangeImage& image_;
  int32_t first_row_, rows_, columns_;
  CellGrid grid_;
  std::array<double, 2> slack_;
  std::vector<RowInTable> at_;
  std::vector<std::array<double, 3>> terms_;  // of each row: n . P - d = 1 + 2 y + 3 z
  std::vector<int32_t> owner_, stamp_;        // by cell of the sweep; number of the region, or 0
  int32_t stamped_ = 0;
  double noise_ = 0, least_sigma_ = 0;
  int32_t block_rows_ = 0, block_columns_ = 0, erosion_rows_ = 0, erosion_columns_ = 0;
  std::vector<Grown> regions_;
  GrownPlanes result_;
};

}  // namespace

GrownPlanes GrowPlanes(const RangeImage& image, size_t sweep, const System& system,
                       const std::array<double, 2>& slack) {
  return Grower(image, sweep, system, slack).Grow();
}

}  // namespace scancal::turntable
