#include "tests/integration/swaying_person.hpp"

#include "core/config/rig.hpp"
#include "tests/support/source_dir.hpp"
#include "tests/unit/site_node/capsule_room.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include <cmath>
#include <stdexcept>
#include <utility>

namespace atrium::test {

void write_swaying_person(const std::filesystem::path& folder, int num_instants) {
    const std::filesystem::path file = source_dir() + "/deploy/rigs/full_body.toml";
    std::filesystem::create_directories(folder);
    std::filesystem::copy_file(file, folder / "rig.toml");
    const auto rig = config::load_rig(file);
    if (!rig) throw std::runtime_error(rig.error().message);
    for (int instant = 0; instant < num_instants; ++instant) {
        const auto body =
            site_node::test::make_body({0.05 * instant, 0.1 * std::sin(instant), 0.0});
        for (const geometry::CalibratedCamera& camera : rig->cameras) {
            const image::Mask mask = site_node::test::draw(body, camera);
            const cv::Mat white(
                mask.height, mask.width, CV_8U, const_cast<std::uint8_t*>(mask.row(0)));
            const cv::Mat picture = 90 + 0.4 * white;
            for (const auto& [what, pixels] :
                 {std::pair("frames", picture), std::pair("silhouettes", white)}) {
                std::filesystem::create_directories(folder / camera.name / what);
                const std::string name = fmt::format("{:06}.png", instant);
                if (!cv::imwrite((folder / camera.name / what / name).string(), pixels))
                    throw std::runtime_error("cannot write " + folder.string());
            }
        }
    }
}

}  // namespace atrium::test
