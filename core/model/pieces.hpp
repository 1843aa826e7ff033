#pragma once

#include "core/model/model_file.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <string>
#include <vector>

namespace atrium::model {

/// What becomes one hull of a compound.
struct Piece {
    std::string name;                     // of the part, else a number from 1
    std::vector<Eigen::Vector3d> points;  // [m], in the model's frame
};

/// The pieces of a model: its parts, or, for formats without parts (STL, PLY, OFF), its connected
/// surfaces in the order of their first vertices.
std::vector<Piece> pieces_of(const std::vector<ModelPart>& parts,
                             const std::filesystem::path& file);

}  // namespace atrium::model
