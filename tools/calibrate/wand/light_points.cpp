#include "tools/calibrate/wand/light_points.hpp"

#include "core/base/text_file.hpp"
#include "core/config/rig.hpp"
#include "tools/calibrate/formats/rig_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kMaxPointsBytes = std::size_t{512} << 20U;
constexpr std::size_t kMaxCameras = 64;
constexpr std::uint32_t kMaxLight = 15;
constexpr double kMaxPlace_px = 1e5;

enum Column : std::size_t { kCamera, kInstant, kLight, kX, kY, kNumColumns };
constexpr std::array<std::string_view, kNumColumns> kColumnNames{
    "camera", "instant", "light", "x_px", "y_px"};

std::string_view trimmed(std::string_view text) {
    const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    return text;
}

std::vector<std::string_view> fields_of(std::string_view line) {
    std::vector<std::string_view> fields;
    for (;;) {
        const std::size_t end = line.find(',');
        fields.push_back(trimmed(line.substr(0, end)));
        if (end == std::string_view::npos) return fields;
        line.remove_prefix(end + 1);
    }
}

template <typename Number>
std::optional<Number> number_of(std::string_view text) {
    Number number{};
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (failure != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return number;
}

class PointsReader {
public:
    explicit PointsReader(std::string file) : file_(std::move(file)) {}

    Expected<LightPoints> read(std::string_view text) {
        if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // of a spreadsheet
        while (!text.empty()) {
            const std::size_t end = text.find('\n');
            ++line_;
            const std::string_view line = trimmed(text.substr(0, end));
            text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
            if (line.empty()) continue;
            const auto done = column_count_ == 0 ? read_header(line) : read_point(line);
            if (!done) return tl::unexpected(done.error());
        }
        if (cameras_.empty())
            return make_error(ErrorKind::kInvalidData, file_ + ": holds no points");
        for (LightCamera& camera : cameras_)
            std::ranges::stable_sort(camera.points, {}, &LightPoint::instant);
        return std::move(cameras_);
    }

private:
    tl::unexpected<Error> problem(const std::string& text) const {
        return make_error(ErrorKind::kInvalidData, fmt::format("{}:{}: {}", file_, line_, text));
    }

    Expected<void> read_header(std::string_view line) {
        const auto names = fields_of(line);
        column_count_ = names.size();
        for (std::size_t c = 0; c < kNumColumns; ++c) {
            const auto found = std::ranges::find(names, kColumnNames[c]);
            if (found != names.end()) {
                columns_[c] = static_cast<std::size_t>(found - names.begin());
            } else if (c != kLight) {
                return problem(fmt::format(
                    "the first line must name the columns, separated by commas: "
                    "camera,instant,light,x_px,y_px; '{}' is missing{}",
                    kColumnNames[c],
                    line.find(';') != std::string_view::npos ? " (it has semicolons)" : ""));
            }
        }
        return {};
    }

    Expected<void> read_point(std::string_view line) {
        const auto fields = fields_of(line);
        if (fields.size() != column_count_)
            return problem(
                fmt::format("has {} fields; the first line names {} (a decimal comma "
                            "makes two of one number)",
                            fields.size(),
                            column_count_));
        const std::string name(fields[*columns_[kCamera]]);
        if (!config::is_valid_name(name))
            return problem(
                fmt::format("camera '{}': a name has 1 to 63 characters of A-Z, a-z, "
                            "0-9, '_', '.', '-'",
                            name));
        LightPoint point;
        const auto instant = number_of<std::uint32_t>(fields[*columns_[kInstant]]);
        if (!instant)
            return problem(fmt::format("instant '{}' is not a whole number from 0 on",
                                       fields[*columns_[kInstant]]));
        point.instant = *instant;
        if (columns_[kLight] && !fields[*columns_[kLight]].empty()) {
            point.light = number_of<std::uint32_t>(fields[*columns_[kLight]]);
            if (!point.light || *point.light > kMaxLight)
                return problem(fmt::format("light '{}' is not a whole number of 0 to {}",
                                           fields[*columns_[kLight]],
                                           kMaxLight));
        }
        for (const std::size_t axis : {0U, 1U}) {
            const std::string_view text = fields[*columns_[kX + axis]];
            const auto value = number_of<double>(text);
            if (!value || !(std::abs(*value) <= kMaxPlace_px))
                return problem(fmt::format(
                    "{} '{}' is not a place in a picture", kColumnNames[kX + axis], text));
            point.px[static_cast<Eigen::Index>(axis)] = *value;
        }
        const auto [camera, is_new] = index_of_.try_emplace(name, cameras_.size());
        if (is_new) {
            if (cameras_.size() == kMaxCameras)
                return problem(fmt::format("names more than {} cameras", kMaxCameras));
            cameras_.push_back({name, {}});
        }
        cameras_[camera->second].points.push_back(point);
        return {};
    }

    std::string file_;
    std::size_t line_ = 0;
    std::size_t column_count_ = 0;
    std::array<std::optional<std::size_t>, kNumColumns> columns_{};
    LightPoints cameras_;
    std::map<std::string, std::size_t> index_of_;
};

}  // namespace

Expected<LightPoints> load_light_points(const std::filesystem::path& file) {
    const auto text = read_text_file(file, kMaxPointsBytes);
    if (!text) return tl::unexpected(text.error());
    return PointsReader(file.string()).read(*text);
}

Expected<void> save_light_points(const LightPoints& cameras, const std::filesystem::path& file) {
    std::string text = "camera,instant,light,x_px,y_px\n";
    for (const LightCamera& camera : cameras) {
        for (const LightPoint& point : camera.points) {
            text += fmt::format("{},{},{},{:.4f},{:.4f}\n",
                                camera.name,
                                point.instant,
                                point.light ? std::to_string(*point.light) : "",
                                point.px.x(),
                                point.px.y());
        }
    }
    return write_text(file, text, /*may_replace=*/true);
}

}  // namespace atrium::calibrate
