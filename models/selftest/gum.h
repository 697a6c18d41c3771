// The worked examples of the GUM (JCGM 100:2008, Annex H): inputs and published results.
#pragma once
#include "solver/results.h"

namespace scancal {

SelftestRow CheckGaugeBlock();   // H.1: budget, effective degrees of freedom, coverage factor
SelftestRow CheckImpedance();    // H.2: correlated inputs, correlated results
SelftestRow CheckThermometer();  // H.3: a calibration line, and a value predicted by it

}  // namespace scancal
