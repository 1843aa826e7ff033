#include "viewer/config/viewpoints.hpp"

#include "core/app/log.hpp"
#include "viewer/config/user_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <utility>

namespace atrium::viewer {
namespace {

namespace fs = std::filesystem;

constexpr config::Range kViewpointM{-1000.0, 1000.0};
constexpr std::size_t kMaxName = 63;
constexpr std::size_t kMaxEntries = 2048;  // of all worlds; the oldest are dropped

// UTF-8 without control characters, cut between two characters.
std::string printable(std::string name) {
    const auto is_control = [](char c) { return (c >= 0 && c < ' ') || c == 0x7f; };
    std::replace_if(name.begin(), name.end(), is_control, '?');
    if (name.size() <= kMaxName) return name;
    const auto continues = [&](std::size_t i) {
        return (static_cast<unsigned char>(name[i]) & 0xc0U) == 0x80U;
    };
    std::size_t end = kMaxName;
    while (end > 0 && continues(end)) --end;
    return name.substr(0, end);
}

Viewpoint read_viewpoint(config::TableReader& table) {
    Viewpoint viewpoint;
    for (const char* key : {"name", "position_m", "target_m"}) table.require(key);
    table.read("name", viewpoint.name);
    viewpoint.name = printable(viewpoint.name);
    table.read("position_m", viewpoint.camera.position_m.data(), 3, kViewpointM);
    table.read("target_m", viewpoint.camera.target_m.data(), 3, kViewpointM);
    table.read("fov_deg", viewpoint.camera.fov_deg, {5.0, 150.0});
    if ((viewpoint.camera.position_m - viewpoint.camera.target_m).norm() < 1e-3)
        table.reject("target_m", "must differ from position_m");
    return viewpoint;
}

// An entry of the user's file.
struct Entry {
    std::string world;
    int number = 1;
    Viewpoint viewpoint;
};

Expected<std::vector<Entry>> read_entries(const fs::path& file) {
    std::vector<Entry> entries;
    std::error_code failure;
    if (file.empty() || !fs::exists(file, failure)) return entries;
    auto reader = config::TableReader::load(file);
    if (!reader) return tl::unexpected(reader.error());
    for (config::TableReader& table : reader->tables("viewpoint")) {
        Entry entry;
        for (const char* key : {"world", "number"}) table.require(key);
        table.read("world", entry.world);
        table.read("number", entry.number, {1, ViewpointBook::kNum});
        entry.viewpoint = read_viewpoint(table);
        entries.push_back(std::move(entry));
    }
    if (auto read = reader->finish(); !read) return tl::unexpected(read.error());
    return entries;
}

std::string text_of(const Entry& entry) {
    const renderer::ViewCamera& camera = entry.viewpoint.camera;
    const auto point = [](const Eigen::Vector3d& p) {
        return fmt::format("[{:.4f}, {:.4f}, {:.4f}]", p.x(), p.y(), p.z());
    };
    return fmt::format(
        "[[viewpoint]]\nworld = {}\nnumber = {}\nname = {}\nposition_m = {}\ntarget_m = {}\n"
        "fov_deg = {:.2f}\n\n",
        quoted(entry.world),
        entry.number,
        quoted(entry.viewpoint.name),
        point(camera.position_m),
        point(camera.target_m),
        camera.fov_deg);
}

}  // namespace

void read_viewpoints(config::TableReader& reader, std::vector<Viewpoint>& viewpoints) {
    for (config::TableReader& table : reader.tables("viewpoint")) {
        viewpoints.push_back(read_viewpoint(table));
        if (viewpoints.size() > ViewpointBook::kNum)
            table.reject("name", "at most 9 viewpoints have a number");
    }
}

ViewpointBook::ViewpointBook(const std::vector<Viewpoint>& given, fs::path file, std::string world)
    : file_(std::move(file)), world_(std::move(world)) {
    for (std::size_t i = 0; i < std::min(given.size(), given_.size()); ++i) given_[i] = given[i];
    const auto entries = read_entries(file_);
    if (!entries) {
        app::log::warn(
            "viewpoints_unreadable reason=\"{}\"; the next viewpoint that you keep starts a "
            "new file, and this one becomes {}.damaged",
            entries.error().message,
            file_.string());
        return;
    }
    for (const Entry& entry : *entries)
        if (entry.world == world_) own_[index(entry.number)] = entry.viewpoint;
}

const std::optional<Viewpoint>& ViewpointBook::at(int number) const {
    assert(number >= 1 && number <= kNum);
    const auto& own = own_[index(number)];
    return own ? own : given_[index(number)];
}

Expected<void> ViewpointBook::keep(int number, Viewpoint viewpoint) {
    if (viewpoint.name.empty())
        viewpoint.name = at(number) ? at(number)->name : fmt::format("view {}", number);
    viewpoint.name = printable(viewpoint.name);
    own_[index(number)] = std::move(viewpoint);
    return save();
}

Expected<void> ViewpointBook::forget(int number) {
    own_[index(number)].reset();
    return save();
}

int ViewpointBook::next(int from, int step) const {
    int number = from == 0 && step < 0 ? 1 : from;
    for (int i = 0; i < kNum; ++i) {
        number = (number - 1 + step + kNum) % kNum + 1;
        if (at(number)) return number;
    }
    return 0;
}

// Reads the file again first: another viewer may have written viewpoints of another world.
Expected<void> ViewpointBook::save() {
    if (file_.empty()) return {};
    auto entries = read_entries(file_);
    if (!entries) {
        keep_damaged(file_);
        entries = std::vector<Entry>{};
    }
    std::erase_if(*entries, [&](const Entry& entry) { return entry.world == world_; });
    for (int number = 1; number <= kNum; ++number) {
        if (const auto& own = own_[index(number)]) entries->push_back({world_, number, *own});
    }
    std::string text = "# Viewpoints of the viewer (docs/viewer_window.md)\n\n";
    const std::size_t first = entries->size() - std::min(entries->size(), kMaxEntries);
    for (std::size_t i = first; i < entries->size(); ++i) text += text_of((*entries)[i]);
    return replace_file(file_, text);
}

}  // namespace atrium::viewer
