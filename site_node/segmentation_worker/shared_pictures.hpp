#pragma once

#include "core/base/descriptor.hpp"
#include "core/base/expected.hpp"
#include "site_node/segmentation_worker/protocol.hpp"

#include <cstdint>
#include <string_view>

namespace atrium::segmentation_worker {

/// The memory that a site shares with a worker, for one camera. The worker may write anything
/// anywhere in it at any time, but cannot change its size: a read of the site never fails.
class SharedPictures {
public:
    /// Errors: kUnavailable without memory.
    static Expected<SharedPictures> create(const Layout& layout,
                                           std::uint32_t deadline_us,
                                           std::string_view camera);
    SharedPictures(SharedPictures&& other) noexcept;
    SharedPictures& operator=(SharedPictures&&) = delete;
    ~SharedPictures();

    const Layout& layout() const { return layout_; }
    /// To be passed to the worker.
    int descriptor() const { return descriptor_.get(); }

    std::uint8_t* background() { return bytes_ + layout_.background_offset; }
    std::uint8_t* picture() { return bytes_ + layout_.picture_offset; }
    std::uint8_t* last_mask() { return bytes_ + layout_.last_mask_offset; }
    const std::uint8_t* alpha() const { return bytes_ + layout_.alpha_offset; }

private:
    SharedPictures(const Layout& layout, Descriptor descriptor, std::uint8_t* bytes)
        : layout_(layout), descriptor_(std::move(descriptor)), bytes_(bytes) {}

    Layout layout_;
    Descriptor descriptor_;
    std::uint8_t* bytes_;
};

}  // namespace atrium::segmentation_worker
