#pragma once

#include "core/base/expected.hpp"
#include "core/config/table_reader.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

/// A viewpoint with a name.
struct Viewpoint {
    std::string name;  // UTF-8 without control characters, at most 63 bytes
    renderer::ViewCamera camera;
};

/// Reads the tables `[[viewpoint]]` of a viewer file: name, position_m, target_m, fov_deg.
void read_viewpoints(config::TableReader& reader, std::vector<Viewpoint>& viewpoints);

/// The viewpoints of one world under the numbers 1 to 9: those of the viewer file in its order, and
/// those that the user kept, which replace them. The user's are in a file with those of all worlds.
class ViewpointBook {
public:
    static constexpr int kNum = 9;

    /// `given`: of the viewer file. `file`: the user's; empty: kept until the viewer ends. Logs
    /// a file that cannot be read and goes on without it.
    ViewpointBook(const std::vector<Viewpoint>& given,
                  std::filesystem::path file,
                  std::string world);

    /// `number` from 1. Empty: no viewpoint.
    const std::optional<Viewpoint>& at(int number) const;
    /// Keeps the viewpoint in the user's file. An empty name: that of the former one, or "view N".
    /// Error kUnavailable if the file cannot be written; the viewpoint then lasts until the end.
    Expected<void> keep(int number, Viewpoint viewpoint);
    /// Forgets the user's viewpoint. One of the viewer file shows again.
    Expected<void> forget(int number);
    bool is_own(int number) const { return own_[index(number)].has_value(); }
    /// The next number with a viewpoint after `from` (0: none), round the end. 0: there is none.
    int next(int from, int step) const;

private:
    static std::size_t index(int number) { return static_cast<std::size_t>(number - 1); }
    Expected<void> save();

    std::array<std::optional<Viewpoint>, kNum> given_;
    std::array<std::optional<Viewpoint>, kNum> own_;
    std::filesystem::path file_;
    std::string world_;
};

}  // namespace atrium::viewer
