#include "site_node/hosts/model_part_watch.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::hosts {

ModelPartWatch::ModelPartWatch(const std::vector<HostEntry>& hosts, Time start) : last_(start) {
    const auto model = std::ranges::find(hosts, true, &HostEntry::is_model);
    if (model != hosts.end()) host_ = model->name;
}

std::optional<HostEvent> ModelPartWatch::look(bool is_heard, Time now) {
    if (is_heard) {
        last_ = now;
        told_missing_ = false;
        if (is_there_) return std::nullopt;
        is_there_ = true;
        return HostEvent{false, fmt::format("model_part_there host={}", host_)};
    }
    if (told_missing_ || now - last_ < kPatience) return std::nullopt;
    told_missing_ = true;
    is_there_ = false;
    return HostEvent{true,
                     fmt::format("model_part_missing host={} reason=\"nothing comes from it\" "
                                 "advice=\"is site_node running there? is the network up?\"",
                                 host_)};
}

}  // namespace atrium::hosts
