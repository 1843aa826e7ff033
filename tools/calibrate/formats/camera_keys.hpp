#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/formats/data_tree.hpp"
#include "tools/calibrate/judge/reading.hpp"

#include <array>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

/// The keys of one camera in files of named numbers. OpenCV documents what camera_matrix and
/// distortion mean, but not the keys: these are the usual ones of its samples, ROS, and programs
/// around it.
namespace atrium::calibrate {

using Keys = std::initializer_list<const char*>;

/// Values of one camera, from one or more files.
struct Found {
    const Tree* matrix = nullptr;
    const Tree* wide_matrix = nullptr;  // under a key of `matrix`, but of 3x4 or 4x4 numbers
    const Tree* focal = nullptr;        // a map with numbers of kFocal
    const Tree* distortion = nullptr;
    const Tree* coefficients = nullptr;  // a map with k1
    const Tree* rotation = nullptr;
    const Tree* translation = nullptr;
    const Tree* pose = nullptr;
    std::string rotation_key;
    std::string translation_key;
    std::string pose_key;
    std::string wide_key;
    std::optional<Reading::Pose> meaning;  // that the keys say, as R_wc and t_wc do
    bool is_mixed = false;                 // R_wc and t_cw: the rotation is the other way round
    const Tree* width = nullptr;
    const Tree* height = nullptr;
    const Tree* size = nullptr;
    const Tree* model = nullptr;
    std::string where;
};

/// fx, fy, cx, cy; the principal point has another name in files of RealSense.
inline constexpr std::array<Keys, 4> kFocal{Keys{"fx"}, {"fy"}, {"cx", "ppx"}, {"cy", "ppy"}};

/// Finds the values of all cameras.
class CameraKeys {
public:
    /// Moves the values of maps such as "intrinsics" and "extrinsics" to the camera that they are
    /// in, unless it has such values itself.
    static Tree flattened(Tree tree, int depth = 0);

    /// Endings of keys, as "_world" of R_world and T_world, that cannot name cameras: several files
    /// have the same key, or the only ending stands beside keys without one.
    static std::set<std::string> find_words(const std::vector<Tree>& trees);

    explicit CameraKeys(std::set<std::string> words) : words_(std::move(words)) {}

    /// `tree` must outlive this and be flattened. A camera that has no other name is called `name`.
    /// Error kInvalidData for too many cameras.
    Expected<void> add(const Tree& tree,
                       const std::filesystem::path& file,
                       const std::string& name);
    /// After the last file: gives poses that are named by two cameras, as "cam2_to_cam1", to the
    /// first of them, and takes wide matrices beside intrinsics for poses (OpenPose).
    void finish();

    const std::map<std::string, Found>& cameras() const { return cameras_; }

private:
    Expected<void> add_stereo(const Tree& tree);
    void add_keys(const Tree& tree, const std::string& suffix, const std::string& name);
    void add_map(const Tree& tree, const std::string& name, int depth);

    std::set<std::string> words_;
    std::map<std::string, Found> cameras_;
    std::string where_;
    const Tree* of_all_ = nullptr;  // the file, if it has a picture size at its top
    bool found_some_ = false;       // in this file
    bool has_stereo_ = false;
    Tree no_rotation_ = {0.0, 0.0, 0.0};
};

/// Why a value of a camera cannot be read, for messages: "cam3.K: '900,5' is not a number; decimals
/// have a point: 900.5". Empty: there is none. A camera with it would look like no camera.
std::string unreadable_value(const Tree& tree);

/// Keys with numbers that mean nothing here, in a file, at most 12, without repetition. `words`:
/// see CameraKeys::find_words.
void add_unknown_keys(const Tree& tree,
                      const std::set<std::string>& words,
                      std::vector<std::string>& unknown);

}  // namespace atrium::calibrate
