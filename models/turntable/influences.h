// `influences:` of a turntable's dataset.yaml.
#pragma once
#include "models/turntable/declaration.h"

namespace scancal {

// Sets role and u of the model's quantities, or an Error that names the influence and what was expected.
Result<void> SetInfluences(const Dataset& dataset, Turntable* model, TurntableDeclaration* declaration);

}  // namespace scancal
