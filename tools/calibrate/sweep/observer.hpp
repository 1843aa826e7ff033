#pragma once

#include "core/config/rig.hpp"
#include "core/image/raw_image.hpp"
#include "site_node/capture/metaframe.hpp"
#include "site_node/preview/preview_picture.hpp"
#include "tools/calibrate/wand/solve_wand.hpp"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace atrium::calibrate {

/// Looks for something in the pictures of cameras, and knows how much of it is still missing.
class Observer {
public:
    explicit Observer(std::vector<NominalCamera> cameras) : cameras_(std::move(cameras)) {}
    virtual ~Observer() = default;

    /// In the order of the rig.
    const std::vector<NominalCamera>& cameras() const { return cameras_; }

    /// Looks at the picture of a camera at the next instant; an empty one was not delivered. On any
    /// thread, cameras beside each other.
    virtual void look(std::size_t camera, const image::RawImage& image) = 0;

    /// Counts what all cameras saw at an instant. Its number and its time grow.
    virtual void count(const capture::Metaframe& instant) = 0;

    virtual bool is_complete() const = 0;

    /// What is there and what is missing, in one line; at most `most_characters` long, 0: all.
    virtual std::string progress(std::size_t most_characters) const = 0;

    /// What was noticed since the last call, each with its cure.
    virtual std::vector<std::string> take_warnings() = 0;

    /// What a preview shows of the instant that was counted last.
    virtual std::vector<preview::View> views(const capture::Metaframe& instant) const = 0;

private:
    std::vector<NominalCamera> cameras_;
};

/// Names and sizes of the cameras of a source; no focal lengths.
std::vector<NominalCamera> nominal_cameras(const config::Rig& rig);

}  // namespace atrium::calibrate
