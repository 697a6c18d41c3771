// A robot in the tables of a result, and what a result says of its links. mm, rad.
#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>
#include "io/result.h"
#include "models/chain/chain.h"
#include "models/scanner.h"

namespace scancal {

// Poses of a robot: q1 .. qn of the joints, x, y, z of the flange in the base, then `more`.
NumberTable PoseTable(size_t joints, const std::vector<std::pair<std::string, Unit>>& more);
void AddPose(const std::vector<double>& joints, const Eigen::Vector3d& flange, const std::vector<double>& more,
             NumberTable* poses);

// Residuals of points seen from those poses: pose (row of its table), x, y, z.
NumberTable PointResidualTable();

// Parameter::nominal of theta_1 .. beta_n.
void AddNominal(const std::vector<Link>& links, Calibration* calibration);

// Values of these parameters, in this order. An Error names one that the calibration does not have.
Result<Eigen::VectorXd> ValuesOf(const Calibration& calibration, const std::vector<std::string>& names);

// theta_1 .. beta_n of all links. An Error also where the calibration has more links than these.
Result<std::vector<Link>> LinkErrorsOf(const Calibration& calibration, size_t links);

// What the joints do besides (DeclareJointTerms), of all links; those that the calibration does not have are zero.
std::vector<double> JointTermsOf(const Calibration& calibration, size_t links);

// Nominal links of a result (Parameter::nominal); empty: of poses that were given.
std::vector<Link> NominalLinksOf(const Calibration& calibration);

// Points of a tool at joint angles q1 .. qn, in the base, with the uncertainty of the calibration: derivatives by
// central differences over a tenth of each u. point: in the base, of the parameters' values by name, the pose's joints
// and terms, and the last three numbers of a reading (x, y, z; mm). The sense of the last move is not known here:
// backlash is left out.
using PointOfTool = std::function<Eigen::Vector3d(const std::function<double(const std::string&)>& value,
                                                  const std::vector<double>& joints, const Eigen::Vector3d& at)>;
Result<Propagation> PropagateTool(const Calibration& calibration, const PointRequest& points, bool distances,
                                  const PointOfTool& point);

}  // namespace scancal
