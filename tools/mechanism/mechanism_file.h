// Mechanism files (format `sinew-mechanism`, version 1) in, tables of coordinates out.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "mechanism/format.h"
#include "sinew/multibody/simulation.h"

namespace sinew::mechanism {

/// Reads a parsed file. "" or what is wrong with which element. Unknown keys are ignored where the schema
/// allows notes, unknown types and names are not.
std::string from_json(const nlohmann::json& file, multibody::Mechanism& out);

/// Reads a file. "" or "FILE: what is wrong".
std::string load_mechanism(const std::string& path, multibody::Mechanism& out);

/// Samples as CSV with 17 digits: t, q:<joint>…, u:<joint>…, x:,y:,z:<point>…, kinetic, potential.
std::string samples_csv(const multibody::Model& model, const multibody::SimulationResult& result);

}  // namespace sinew::mechanism
