#pragma once

#include "tools/calibrate/recording/gather.hpp"
#include "tools/calibrate/recording/instants.hpp"
#include "tools/calibrate/recording/single_rooms.hpp"
#include "tools/calibrate/recording/words.hpp"

#include <limits>
#include <string>
#include <vector>

/// The steps of `gather`, in several files.
namespace atrium::calibrate {

/// Finds and matches the pictures of one rig step by step; each step leaves its sentences.
class Gatherer {
public:
    Gatherer(const std::vector<std::string>& cameras, const PictureFolders& folders)
        : cameras_(cameras), folders_(folders) {}

    Expected<Material> run();

private:
    Expected<void> sort_out(const std::vector<Shots>& found);
    std::string cure_of_two() const;
    std::vector<std::string> drop_pictures_of(const std::string& other);
    void drop_others();
    bool has_name(const std::string& camera, const Shots& shots) const;
    void take_missing(const std::vector<std::string>& cameras);
    void doubt_markers(const std::vector<std::string>& without);
    Expected<void> gather_frames();
    void report_missing(const std::vector<std::string>& unused);
    Expected<void> drop_other_names();
    void take_times();
    void drop_other_instants();
    void take_numbering();
    Expected<void> look_at_all();
    void compare_rates();
    Expected<void> compare_numbers();
    void report_truncated(const std::string& camera, const std::string& doubt);
    Expected<void> gather_masks();
    Expected<void> find_masks();
    Expected<void> check_masks();
    void read_labels();
    std::string without_masks() const;
    Expected<void> align_masks();
    Expected<void> gather_backgrounds();
    RoomOwners room_owners() const;
    Expected<void> read_rooms_one_by_one(Matches& matches);
    Expected<void> check_that_rooms_differ() const;
    void report_found_rooms();
    void report_backgrounds(const std::vector<std::string>& without);

    // the names that the user knows
    std::vector<std::string> known_names(std::vector<std::string> cameras) const {
        for (std::string& camera : cameras) camera = known_name(camera, folders_.originals);
        return cameras;
    }
    std::string known(const std::vector<std::string>& cameras) const {
        return listed(known_names(cameras));
    }
    void tell(std::string text) { material_.told.push_back(std::move(text)); }
    void check(std::string text) { material_.checks.push_back(std::move(text)); }
    void problem(std::string text) { material_.problems.push_back(std::move(text)); }

    const std::vector<std::string>& cameras_;
    const PictureFolders& folders_;
    Originals names_;  // of the cameras, in the pictures
    std::vector<std::string> with_frames_;
    std::string why_missed_;  // cameras for markers
    std::vector<Shots> frames_;
    std::vector<Shots> rooms_;
    std::vector<Shots> masks_;
    Numbering numbering_;                                           // of the pictures' files
    std::size_t fewest_ = std::numeric_limits<std::size_t>::max();  // pictures of a camera
    Material material_;
};

}  // namespace atrium::calibrate
