// Who knows how the data were made: the narrowest interval that an honest estimate can state.
#pragma once
#include <Eigen/Core>
#include <vector>
#include "models/turntable/compress.h"
#include "models/turntable/simulate.h"

namespace scancal::coverage {

struct Guess {            // of M, N; mm
  Eigen::Vector2d sigma;  // its standard deviation
  Eigen::Vector2d error;  // from these data
};

// Generalised least squares of M, N and the planes with the true covariance of the profiles' lines: noise, what a
// first-order autoregressive process adds to offset and slope, jitter, and the form of each plate as random amplitudes
// of the declared modes. Linearised at the truth. Of a form that is not made of the modes it knows no more than we.
class Oracle {
 public:
  explicit Oracle(const turntable::Scene& scene);
  Guess Ask(const std::vector<turntable::Placement>& seen) const;  // what reading left of a data set of the scene

 private:
  struct Bend {  // of a profile, by every mode: offset + slope z, the least squares line through the form at its points
    Eigen::RowVectorXd offset, slope;
  };
  struct Plate {
    Eigen::Vector3d normal;
    double distance;
    std::vector<Bend> bends;  // per profile
  };
  std::vector<Bend> BendsOf(const Plate& plate, const std::vector<turntable::SimulatedProfile>& profiles) const;

  turntable::Scene scene_;
  std::vector<Plate> plates_;
};

}  // namespace scancal::coverage
