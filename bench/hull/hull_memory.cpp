#include "bench/hull/hull_scenes.hpp"
#include "core/base/thread_pool.hpp"

#include <malloc.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <new>
#include <string>

// Bytes that a HullScratch holds after computing a hull, as comma-separated values. Counts the heap
// of the whole program with a custom operator new.
namespace {

std::atomic<std::int64_t> num_bytes{0};

void* count(void* memory) {
    if (memory == nullptr) throw std::bad_alloc();
    num_bytes += static_cast<std::int64_t>(malloc_usable_size(memory));
    return memory;
}

void release(void* memory) {
    num_bytes -= static_cast<std::int64_t>(malloc_usable_size(memory));
    std::free(memory);
}

void* aligned(std::size_t size, std::align_val_t alignment) {
    const auto step = static_cast<std::size_t>(alignment);
    return count(std::aligned_alloc(step, (size + step - 1) / step * step));
}

}  // namespace

void* operator new(std::size_t size) { return count(std::malloc(size)); }
void* operator new[](std::size_t size) { return count(std::malloc(size)); }
void* operator new(std::size_t size, std::align_val_t step) { return aligned(size, step); }
void* operator new[](std::size_t size, std::align_val_t step) { return aligned(size, step); }
void operator delete(void* memory) noexcept { release(memory); }
void operator delete[](void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }

namespace atrium::bench {
namespace {

void measure(const std::string& name,
             const std::vector<hull::SilhouetteView>& views,
             std::size_t threads) {
    ThreadPool pool(threads);
    hull::VisualHull hull;
    auto scratch = std::make_unique<hull::HullScratch>();
    for (int i = 0; i < 2; ++i) hull::compute_visual_hull(views, {}, *scratch, pool, hull);
    const std::int64_t with = num_bytes;
    scratch.reset();
    const std::int64_t scratch_bytes = with - num_bytes;
    const std::int64_t mesh_bytes =
        static_cast<std::int64_t>(hull.mesh.vertices.capacity() * sizeof(Eigen::Vector3d) +
                                  hull.mesh.triangles.capacity() * 3 * sizeof(std::uint32_t));
    std::printf("%s,%zu,%zu,%zu,%zu,%.2f,%.2f\n",
                name.c_str(),
                views.size(),
                num_segments(views),
                threads,
                hull.mesh.triangles.size(),
                static_cast<double>(scratch_bytes) / 1e6,
                static_cast<double>(mesh_bytes) / 1e6);
}

}  // namespace
}  // namespace atrium::bench

int main() {
    using namespace atrium::bench;
    std::printf("scene,views,segments,threads,triangles,scratch_mb,mesh_mb\n");
    for (const std::size_t threads : {1u, 2u}) {
        for (const std::string name : {"person_10k", "person_24views"}) {
            if (const auto views = shared_set(name)) measure(name, *views, threads);
        }
        measure("person_64views", person_views(64, 250), threads);
    }
    return 0;
}
