#include "viewer/overlay/name_tags.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::viewer {
namespace {

constexpr int kMaxNewTags = 4;  // per picture: rendering a text takes some tenths of a millisecond
constexpr double kAboveHeadM = 0.06;
constexpr double kTagSmoothingS = 0.1;
constexpr double kJumpM = 0.5;  // a head that is farther away jumped
constexpr double kFadesFromM = 8.0;
constexpr double kGoneAtM = 20.0;

double distance_opacity(double distance_m) {
    return std::clamp((kGoneAtM - distance_m) / (kGoneAtM - kFadesFromM), 0.0, 1.0);
}

}  // namespace

std::vector<renderer::Label> NameTags::update(const std::map<std::string, Person>& people,
                                              const std::string& hidden,
                                              const Eigen::Vector3d& eye_world,
                                              Clock::time_point now) {
    const double passed_s = std::chrono::duration<double>(now - time_).count();
    const double share = 1.0 - std::exp(-std::max(passed_s, 0.0) / kTagSmoothingS);
    time_ = now;
    std::erase_if(tags_, [&](const auto& tag) { return !people.contains(tag.first); });
    std::vector<renderer::Label> labels;
    int num_new = 0;
    for (const auto& [name, person] : people) {
        const auto known = tags_.find(name);
        const bool is_drawn = known != tags_.end() && known->second.text_px == text_px_;
        const bool has_room = is_drawn || ++num_new <= kMaxNewTags;
        if (known == tags_.end() && !has_room) continue;
        const auto [found, is_new] = tags_.try_emplace(name);
        Tag& tag = found->second;
        if (!is_drawn && has_room) {
            tag.picture = draw_text(name, text_px_);
            tag.text_px = text_px_;
        }
        if (is_new || (person.top_world - tag.top_world).norm() > kJumpM)
            tag.top_world = person.top_world;
        tag.top_world += share * (person.top_world - tag.top_world);
        const double seen = person.opacity * distance_opacity((tag.top_world - eye_world).norm());
        if (name == hidden || seen <= 0.0) continue;
        labels.push_back({.picture = tag.picture,
                          .at_world = tag.top_world + kAboveHeadM * Eigen::Vector3d::UnitZ(),
                          .height = height_,
                          .opacity = seen});
    }
    return labels;
}

}  // namespace atrium::viewer
