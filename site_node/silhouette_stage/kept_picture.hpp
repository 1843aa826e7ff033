#pragma once

#include "core/image/image.hpp"

#include <algorithm>

namespace atrium::site_node {

/// Copy of a picture that outlives the callback that showed it.
struct KeptPicture {
    image::YuvImage planes;
    image::Mosaic mosaic = image::Mosaic::kNone;

    void keep(const image::YuvView& view) {
        mosaic = view.mosaic;
        copy(view.y, planes.y);
        copy(view.u, planes.u);
        copy(view.v, planes.v);
    }
    image::YuvView view() const {
        image::YuvView result(planes);
        result.mosaic = mosaic;
        return result;
    }

private:
    static void copy(const image::PlaneView& from, image::Plane& to) {
        if (to.width != from.width || to.height != from.height)
            to = image::Plane(from.width, from.height);
        for (int y = 0; y < from.height; ++y) std::copy_n(from.row(y), from.width, to.row(y));
    }
};

}  // namespace atrium::site_node
