#include "site_node/segmentation_worker/shared_pictures.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace atrium::segmentation_worker {

Expected<SharedPictures> SharedPictures::create(const Layout& layout,
                                                std::uint32_t deadline_us,
                                                std::string_view camera) {
    const auto failed = [&](int problem) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("camera '{}': no {} MB of memory to share with the "
                                      "segmentation worker: {}",
                                      camera,
                                      layout.num_bytes >> 20,
                                      std::strerror(problem)));
    };
    Descriptor memory(memfd_create("atrium segmentation", MFD_CLOEXEC | MFD_ALLOW_SEALING));
    if (memory.get() < 0) return failed(errno);
    // reserves the pages: without memory for them a write would end the process
    if (const int problem = posix_fallocate(memory.get(), 0, static_cast<off_t>(layout.num_bytes)))
        return failed(problem);
    if (fcntl(memory.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) < 0)
        return failed(errno);
    void* const bytes = mmap(nullptr,
                             layout.num_bytes,
                             PROT_READ | PROT_WRITE,
                             MAP_SHARED | MAP_POPULATE,
                             memory.get(),
                             0);
    if (bytes == MAP_FAILED) return failed(errno);
    SharedPictures pictures(layout, std::move(memory), static_cast<std::uint8_t*>(bytes));
    const auto header = encode_header(layout, deadline_us, camera);
    std::copy(header.begin(), header.end(), pictures.bytes_);
    return pictures;
}

SharedPictures::SharedPictures(SharedPictures&& other) noexcept
    : layout_(other.layout_),
      descriptor_(std::move(other.descriptor_)),
      bytes_(std::exchange(other.bytes_, nullptr)) {}

SharedPictures::~SharedPictures() {
    if (bytes_ != nullptr) munmap(bytes_, layout_.num_bytes);
}

}  // namespace atrium::segmentation_worker
