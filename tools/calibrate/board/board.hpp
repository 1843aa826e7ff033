#pragma once

#include "core/base/expected.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// kCharuco: a chessboard with an ArUco marker in each white square.
enum class BoardKind : std::uint8_t { kCharuco, kChessboard };

/// A printed calibration board, as it looks from its front. Its frame has the origin at the outer
/// corner of the pattern at the bottom left, +X to the right, +Y up the page and +Z to the viewer.
///
/// Its *corners* are those where four squares meet, numbered from the top left, row by row. The
/// square at the top left is black.
struct Board {
    BoardKind kind = BoardKind::kCharuco;
    int columns = 5, rows = 7;  // squares
    double square_m = 0.036;
    double marker_m = 0.027;                 // of a marker with its black border
    std::string dictionary = "DICT_4X4_50";  // of OpenCV
    /// The markers count from here, from the top left, row by row.
    int first_id = 0;
    bool is_inverted = false;  // white where others are black
    /// As OpenCV before 4.6 made them: with an even number of rows, the square at the top left is
    /// white.
    bool is_legacy = false;

    std::size_t num_corners() const {
        return static_cast<std::size_t>(columns - 1) * static_cast<std::size_t>(rows - 1);
    }
    std::size_t num_markers() const;
    Eigen::Vector3d corner_m(std::size_t corner) const;
    /// `row` from the top.
    bool is_black(int column, int row) const;
    /// Column and row of the square of a marker, by its place in the order of the markers.
    Eigen::Vector2i square_of_marker(std::size_t marker) const;

    /// "a ChArUco board of 5 columns and 7 rows of squares of 36 mm, ..."
    std::string text() const;
    std::string toml() const;
};

/// Names of the dictionaries that a board may have, as OpenCV calls them.
const std::vector<std::string>& dictionary_names();

/// The number of OpenCV for a dictionary; empty for another name.
std::optional<int> dictionary_number(const std::string& name);

/// How many markers the dictionary has.
std::size_t dictionary_size(const std::string& name);

/// Reads the boards of a calibration: one `[[board]]` each, with `kind`, `squares = [columns,
/// rows]`, `square_m`, `marker_m`, `dictionary`, `first_id`, `inverted` and `legacy`. Errors name
/// file and line: sizes that contradict each other, a chessboard that looks the same when turned,
/// boards that share markers.
Expected<std::vector<Board>> load_boards(const std::filesystem::path& file);
/// The same of a text; `name` stands for the file in messages.
Expected<std::vector<Board>> parse_boards(const std::string& toml, const std::string& name);

}  // namespace atrium::calibrate
