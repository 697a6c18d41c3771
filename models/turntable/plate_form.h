// How a simulated plate deviates from its plane.
#pragma once
#include <vector>
#include "solver/random.h"

namespace scancal {

enum class FormKind {
  kModes,   // those of form_modes.h, amplitudes independent and normal
  kSmooth,  // eight plane waves of random direction and phase, 3/4 to 2 sides of the rectangle long, its plane removed
  kBent,    // the same, 1 to 3 times as long as the longer side: mostly bent about one axis
};

struct PlateRectangle {  // on the plate, mm
  double centre_u = 0, centre_v = 0, half_u = 1, half_v = 1;
};

// Smooth form over a rectangle (docs/uncertainty.md, section 2). rms, mm: of kModes expected over the ensemble,
// so that one plate may have twice as much; of the waves of every single plate, a function that the modes do not hold.
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

}  // namespace scancal
