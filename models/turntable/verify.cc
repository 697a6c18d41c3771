#include "models/turntable/verify.h"
#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include "models/turntable/shapes.h"
#include "solver/calibrate.h"
#include "solver/dense.h"
#include "solver/uncertainty/difference.h"
#include "solver/uncertainty/gum.h"

namespace scancal::turntable {
namespace {

struct Noise {  // standard deviations, as the calibration found them
  double y, z, offset, angle;
};

// df/dP of the points of a shape that are on it, one row a point; left: what their residuals do to f.
struct Share {
  const Shape* shape;
  Eigen::MatrixX3d by;
  Eigen::VectorXd left = Eigen::VectorXd::Zero(by.rows());
};

struct MeasuredFeature {
  double value = 0, form = 0, excess = 1;  // excess: variance of the residuals over that of the noise, 1: none
  double excess_dof = kInfinity;
  std::vector<Share> parts;
};

// What noise of standard deviation one of each kind does to a feature: of single points, by target; of profiles.
struct ByNoise {
  std::map<const SeenTarget*, Eigen::VectorXd> of_points;
  std::map<std::pair<std::string, double>, Eigen::Vector2d> of_profiles;
  double Dot(const ByNoise& other) const {
    double sum = 0;
    for (const auto& [target, mine] : of_points)
      if (const auto found = other.of_points.find(target); found != other.of_points.end())
        sum += mine.dot(found->second);
    for (const auto& [profile, mine] : of_profiles)
      if (const auto found = other.of_profiles.find(profile); found != other.of_profiles.end())
        sum += mine.dot(found->second);
    return sum;
  }
};

struct PointMoves {  // by one unit of depth (a lidar's: of the range), height, angle
  Eigen::Vector3d y, z, angle;
};
PointMoves MovesOf(const System& system, const SensorColumns& at, size_t i) {
  const auto point = [&](double dy, double dz) { return system.Point(at.alpha[i], at.y[i] + dy, at.z[i] + dz); };
  const Eigen::Vector3d p = point(0, 0);
  const double along_y = at.range.empty() ? 1 : at.y[i] / at.range[i],
               along_z = at.range.empty() ? 0 : at.z[i] / at.range[i];
  return {point(along_y / 2, along_z / 2) - point(-along_y / 2, -along_z / 2),
          point(0, 0.5) - point(0, -0.5),
          {p.y(), -p.x(), 0}};
}

// (J'J)^-1 J' of r_i = |P_i - c| - R, rows centre and radius.
Eigen::Matrix4Xd GainOf(const Shape& sphere) {
  Eigen::Matrix4Xd rows(4, std::ssize(sphere.on));
  for (size_t k = 0; k < sphere.on.size(); ++k)
    rows.col(static_cast<Eigen::Index>(k)) << (sphere.At(k) - sphere.centre).normalized(), 1;
  const Eigen::Matrix4d square = rows * rows.transpose();
  return square.inverse() * rows;
}

Share ShareOf(const Shape& sphere, const Eigen::RowVector4d& of) {
  const Eigen::RowVectorXd along = of * GainOf(sphere);
  Share part{&sphere, Eigen::MatrixX3d(along.size(), 3)};
  for (Eigen::Index k = 0; k < along.size(); ++k) {
    const Eigen::Vector3d from = sphere.At(static_cast<size_t>(k)) - sphere.centre;
    part.by.row(k) = along[k] * from.normalized().transpose();
    part.left[k] = along[k] * (from.norm() - sphere.radius);
  }
  return part;
}

// Residuals of all points against the noise: directions of the residuals are those of `outward`.
class Scatter {
 public:
  Scatter(const System& system, const Noise& noise) : system_(system), noise_(noise) {}
  void Add(const Shape& shape, size_t k, double residual, const Eigen::Vector3d& outward) {
    const SensorColumns& at = shape.target->points;
    const PointMoves moves = MovesOf(system_, at, shape.on[k]);
    const double expected = std::pow(outward.dot(moves.y), 2) * (std::pow(noise_.y, 2) + std::pow(noise_.offset, 2)) +
                            std::pow(outward.dot(moves.z) * noise_.z, 2) +
                            std::pow(outward.dot(moves.angle) * noise_.angle, 2);
    squares_ += residual * residual;
    in_noise_ += residual * residual / expected;
    ++points_;
    profiles_.emplace(shape.target->scan, at.alpha[shape.on[k]]);
  }
  // parameters: of the shapes. Profiles count, not points: what noise has in common within a profile has no more.
  void Finish(double parameters, MeasuredFeature* measured) const {
    measured->form = std::sqrt(squares_ / points_);
    const double dof = static_cast<double>(profiles_.size()) - parameters;
    const double F = in_noise_ / (points_ - parameters);
    if (dof < 1 || FUpperTail(F, dof, kInfinity) > kSuspicious) return;
    measured->excess = F;
    measured->excess_dof = dof;
  }

 private:
  const System& system_;
  const Noise noise_;
  double squares_ = 0, in_noise_ = 0, points_ = 0;
  std::set<std::pair<std::string, double>> profiles_;
};

MeasuredFeature OfSpheres(const System& system, const Noise& noise, const std::vector<const Shape*>& spheres) {
  MeasuredFeature result;
  Scatter scatter(system, noise);
  for (const Shape* sphere : spheres)
    for (size_t k = 0; k < sphere->on.size(); ++k) {
      const Eigen::Vector3d from = sphere->At(k) - sphere->centre;
      scatter.Add(*sphere, k, from.norm() - sphere->radius, from.normalized());
    }
  scatter.Finish(4 * static_cast<double>(spheres.size()), &result);
  if (spheres.size() == 1) {
    result.value = 2 * spheres[0]->radius;
    result.parts = {ShareOf(*spheres[0], {0, 0, 0, 2})};
    return result;
  }
  const Eigen::Vector3d between = spheres[1]->centre - spheres[0]->centre;
  result.value = between.norm();
  Eigen::RowVector4d along = Eigen::RowVector4d::Zero();
  along.head<3>() = between.transpose() / result.value;
  result.parts = {ShareOf(*spheres[0], -along), ShareOf(*spheres[1], along)};
  return result;
}

// Of one normal n to both: n . (m_2 - m_1), m the means. With x the points from their mean in two directions E across
// n, dn = -E (X'X)^-1 sum x (n . dP), and the offset moves by n . (dm_2 - dm_1) + (m_2 - m_1) . dn.
MeasuredFeature OfPlanes(const System& system, const Noise& noise, const Shape& first, const Shape& second) {
  MeasuredFeature result;
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  for (const Shape* plane : {&first, &second})
    for (size_t k = 0; k < plane->on.size(); ++k) {
      const Eigen::Vector3d d = plane->At(k) - plane->centre;
      square += d * d.transpose();
    }
  const Eigen::Matrix3d vectors = EigenOf(square).vectors;
  const Eigen::Vector3d apart = second.centre - first.centre;
  const Eigen::Vector3d normal = std::copysign(1.0, vectors.col(0).dot(apart)) * vectors.col(0);
  const Eigen::Matrix<double, 3, 2> across = vectors.rightCols<2>();
  const Eigen::Matrix2d inner = across.transpose() * square * across;
  const Eigen::RowVector2d lever = apart.transpose() * across * inner.inverse();
  result.value = normal.dot(apart);
  Scatter scatter(system, noise);
  for (const auto& [plane, sign] : {std::pair{&first, -1.0}, {&second, 1.0}}) {
    const auto n = std::ssize(plane->on);
    Share part{plane, Eigen::MatrixX3d(n, 3)};
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Vector3d d = plane->At(static_cast<size_t>(k)) - plane->centre;
      const double weight = sign / static_cast<double>(n) - lever.dot(d.transpose() * across);
      part.by.row(k) = weight * normal.transpose();
      part.left[k] = weight * normal.dot(d);
      scatter.Add(*plane, static_cast<size_t>(k), normal.dot(d), normal);
    }
    result.parts.push_back(std::move(part));
  }
  scatter.Finish(4, &result);
  return result;
}

Eigen::RowVectorXd BySystem(const System& system, const MeasuredFeature& measured) {
  Eigen::RowVectorXd by = Eigen::RowVectorXd::Zero(System::kQuantities);
  for (const Share& part : measured.parts) {
    const SensorColumns& at = part.shape->target->points;
    for (Eigen::Index k = 0; k < part.by.rows(); ++k) {
      const size_t i = part.shape->on[static_cast<size_t>(k)];
      by += part.by.row(k) * system.Differentiate(at.alpha[i], at.y[i], at.z[i]).by;
    }
  }
  return by;
}

ByNoise NoiseIn(const System& system, const Noise& noise, const MeasuredFeature& measured) {
  ByNoise by;
  const double growth = std::sqrt(measured.excess);
  for (const Share& part : measured.parts) {
    const SensorColumns& at = part.shape->target->points;
    Eigen::VectorXd& points = by.of_points[part.shape->target];
    if (points.size() == 0) points = Eigen::VectorXd::Zero(2 * std::ssize(part.shape->all));
    for (Eigen::Index k = 0; k < part.by.rows(); ++k) {
      const size_t i = part.shape->on[static_cast<size_t>(k)];
      const PointMoves moves = MovesOf(system, at, i);
      const double along_y = growth * part.by.row(k).dot(moves.y);
      points[2 * static_cast<Eigen::Index>(i)] += along_y * noise.y;
      points[2 * static_cast<Eigen::Index>(i) + 1] += growth * part.by.row(k).dot(moves.z) * noise.z;
      Eigen::Vector2d& profile =
          by.of_profiles.try_emplace({part.shape->target->scan, at.alpha[i]}, Eigen::Vector2d::Zero()).first->second;
      profile += Eigen::Vector2d(along_y * noise.offset, growth * part.by.row(k).dot(moves.angle) * noise.angle);
    }
  }
  return by;
}

// Noise that points of a profile share, or a form of the shape, scatters what whole profiles do to the feature.
void GrowWithProfiles(const ByNoise& noise, double parameters, MeasuredFeature* measured) {
  struct Sums {
    double left = 0, variance = 0;
  };
  std::map<std::pair<std::string, double>, Sums> profiles;
  for (const Share& part : measured->parts) {
    const SensorColumns& at = part.shape->target->points;
    const Eigen::VectorXd& points = noise.of_points.at(part.shape->target);
    for (size_t k = 0; k < part.shape->on.size(); ++k) {
      const size_t i = part.shape->on[k];
      Sums& sums = profiles[{part.shape->target->scan, at.alpha[i]}];
      sums.left += part.left[static_cast<Eigen::Index>(k)];
      sums.variance += points.segment<2>(2 * static_cast<Eigen::Index>(i)).squaredNorm();
    }
  }
  double squares = 0, variance = 0, fourth = 0;
  for (const auto& [profile, sums] : profiles) {
    const double expected = sums.variance + noise.of_profiles.at(profile).squaredNorm();
    squares += sums.left * sums.left;
    variance += expected;
    fourth += expected * expected;
  }
  const double dof = variance * variance / fourth - parameters, F = squares / variance;
  if (dof < 1 || FUpperTail(F, dof, kInfinity) > kSuspicious) return;
  measured->excess *= F;
  measured->excess_dof = dof;
}

std::vector<std::string> OutsideNotes(const ScannedVolume& volume, const std::vector<SeenTarget>& targets) {
  std::vector<std::string> notes;
  for (const SeenTarget& target : targets)
    for (size_t i = 0; i < target.points.y.size(); ++i) {
      const std::string beyond =
          volume.Beyond(WholeTurnsAway(volume, target.points.alpha[i]), target.points.y[i], target.points.z[i]);
      if (beyond.empty()) continue;
      notes.push_back("target " + target.name + " lies outside what the calibration has seen: " + beyond);
      break;
    }
  return notes;
}

// deviation = -scale x (its derivative): by generalised least squares with the covariance of all deviations.
std::optional<ScaleFound> ScaleOf(const Eigen::VectorXd& deviations, const Eigen::VectorXd& by_scale,
                                  const Eigen::MatrixXd& covariance, double dof) {
  constexpr double kUseless = 0.01;  // a u of 1 %: nothing was seen of it
  const SymmetricEigen of = EigenOf(covariance);
  const Eigen::VectorXd inverse = of.values.cwiseMax(1e-14 * of.values.maxCoeff()).cwiseInverse();
  const Eigen::VectorXd weighted = of.vectors * inverse.asDiagonal() * of.vectors.transpose() * by_scale;
  const double information = weighted.dot(by_scale);
  if (!(information > 1 / (kUseless * kUseless))) return std::nullopt;
  const double u = 1 / std::sqrt(information);
  return ScaleFound{-weighted.dot(deviations) / information, u, CoverageFactor(kCoverage, dof) * u};
}

}  // namespace

const char* Name(Feature::Kind kind) {
  return kind == Feature::Kind::kDiameter ? "diameter" : kind == Feature::Kind::kDistance ? "distance" : "step";
}

Result<Verification> VerifyFeatures(const Calibration& calibration, const std::vector<SeenTarget>& targets,
                                    const std::vector<Feature>& features) {
  SCANCAL_ASSIGN_OR_RETURN(const PointUncertainty points, PointUncertainty::From(calibration));
  const System& system = points.system();
  const Noise noise = {UOfSource(calibration, "noise_y"), UOfSource(calibration, "noise_z"),
                       UOfSource(calibration, "line_correlation (offset)"), UOfSource(calibration, "encoder_jitter")};
  if (!(noise.y > 0))
    return Error{"the calibration has no noise_y in its budget, as with equal weights; refine with estimated ones"};
  std::map<std::pair<size_t, bool>, Shape> shapes;  // by target and whether it is a plane
  Verification result;
  const auto n = std::ssize(features);
  Eigen::MatrixXd by(n, System::kQuantities);
  std::vector<ByNoise> by_noise;
  std::vector<double> noise_dof;
  for (const Feature& feature : features) {
    const bool plane = feature.kind == Feature::Kind::kStep;
    std::vector<const Shape*> of;
    for (const size_t t : feature.of) {
      auto found = shapes.find({t, plane});
      if (found == shapes.end()) {
        SCANCAL_ASSIGN_OR_RETURN(Shape shape, plane ? PlaneOf(system, targets[t]) : SphereOf(system, targets[t]));
        found = shapes.emplace(std::pair{t, plane}, std::move(shape)).first;
      }
      of.push_back(&found->second);
    }
    MeasuredFeature measured = plane ? OfPlanes(system, noise, *of[0], *of[1]) : OfSpheres(system, noise, of);
    by.row(std::ssize(by_noise)) = BySystem(system, measured);
    const double parameters = plane ? 4 : 4 * static_cast<double>(of.size());
    GrowWithProfiles(NoiseIn(system, noise, measured), parameters, &measured);
    by_noise.push_back(NoiseIn(system, noise, measured));
    noise_dof.push_back(measured.excess_dof);
    VerifiedFeature& verified = result.features.emplace_back();
    verified.name = feature.name;
    verified.at = feature.at;
    verified.kind = Name(feature.kind);
    verified.nominal = feature.nominal;
    verified.measured = measured.value;
    verified.form = measured.form;
    for (const Shape* shape : of) {
      verified.points += shape->on.size();
      verified.set_aside += shape->set_aside();
    }
    if (measured.excess > 1)
      result.notes.push_back(
          fmt::format("{}{}: its points scatter {:.2g} times as much as the calibration's noise; u grows with it{}",
                      feature.name, feature.at.empty() ? "" : " at " + feature.at, std::sqrt(measured.excess),
                      measured.excess < 9 ? "" : "; is it of that shape, and alone in its region (keep:)?"));
  }
  Eigen::VectorXd by_scale, deviations(n);
  const MeasurandUncertainty all = points.Of(by, &by_scale);
  Eigen::MatrixXd covariance = all.covariance;
  for (Eigen::Index k = 0; k < n; ++k) {
    VerifiedFeature& verified = result.features[k];
    const Feature& feature = features[k];
    const MeasurandUncertainty calibrated = points.Of(by.row(k));
    verified.u_calibration = std::sqrt(calibrated.covariance(0, 0));
    verified.u_noise = std::sqrt(by_noise[k].Dot(by_noise[k]));
    verified.u_reference = feature.u;
    const std::array<double, 3> parts = {verified.u_calibration, verified.u_noise, feature.u};
    verified.u = std::hypot(parts[0], parts[1], parts[2]);
    verified.dof = EffectiveDof(parts, std::array<double, 3>{calibrated.dof, noise_dof[k], kInfinity});
    verified.U = CoverageFactor(kCoverage, verified.dof) * verified.u;
    verified.E_n = NormalizedError(verified.deviation(), verified.U);
    if (feature.tolerance)
      verified.conformity = ConformityOf(verified.deviation(), verified.u, verified.dof, (*feature.tolerance)[0],
                                         (*feature.tolerance)[1]);
    deviations[k] = verified.deviation();
    for (Eigen::Index l = 0; l < n; ++l) {
      covariance(k, l) += by_noise[k].Dot(by_noise[l]);
      if (features[l].name == feature.name) covariance(k, l) += feature.u * features[l].u;
    }
  }
  result.scale = ScaleOf(deviations, by_scale, covariance, all.dof);
  const std::vector<std::string> outside = OutsideNotes(points.volume(), targets);
  result.notes.insert(result.notes.end(), outside.begin(), outside.end());
  return result;
}

}  // namespace scancal::turntable
