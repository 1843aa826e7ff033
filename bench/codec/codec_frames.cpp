#include "bench/codec/codec_frames.hpp"

#include "bench/scenes/site_scene.hpp"
#include "core/base/executor.hpp"
#include "core/codec/mask_codec.hpp"
#include "site_node/capture/recording_source.hpp"
#include "site_node/pipeline.hpp"
#include "site_node/texture/texture.hpp"

#include <algorithm>

namespace atrium::bench {
namespace {

// The full-size mask whose half is `half`, with the crop at `crop_px`.
image::Mask doubled(const image::Mask& half,
                    const image::PixelRect& crop_px,
                    int width,
                    int height) {
    image::Mask mask(width, height);
    for (int y = 0; y < crop_px.height; ++y) {
        for (int x = 0; x < crop_px.width; ++x)
            mask.row(crop_px.y + y)[crop_px.x + x] = half.at(x / 2, y / 2);
    }
    return mask;
}

Expected<CodecView> make_view(const geometry::CalibratedCamera& camera,
                              const image::RawImage& raw,
                              const site_node::CodedCamera& coded) {
    CodecView view;
    view.camera = camera;
    view.raw = raw;
    view.picture = image::working_view(view.raw, view.buffer);
    image::Mask half;
    if (auto ok = codec::decode_mask(coded.texture.mask, half); !ok)
        return tl::unexpected(ok.error());
    view.mask = doubled(half, coded.crop_px, raw.width, raw.height);
    texture::TextureScratch scratch;
    const texture::TextureOptions exactly{.padding_px = 0};
    if (!texture::crop_texture(view.picture, view.mask, coded.crop_px, exactly, scratch, view.crop))
        return make_error(ErrorKind::kInvalidData, "a camera that sees nobody was coded");
    return view;
}

Expected<CodecFrame> make_frame(const std::string& scene,
                                const config::Rig& rig,
                                const capture::Metaframe& metaframe,
                                site_node::Pipeline& pipeline) {
    SerialExecutor executor;
    site_node::SiteFrame site_frame;
    if (auto ok = pipeline.process(metaframe, executor, site_frame); !ok)
        return tl::unexpected(ok.error());
    CodecFrame frame{scene, site_frame.hull.mesh, {}};
    frame.views.reserve(site_frame.cameras.size());
    for (const site_node::CodedCamera& coded : site_frame.cameras) {
        auto view =
            make_view(rig.cameras[coded.camera], metaframe.frames[coded.camera].image, coded);
        if (!view) return tl::unexpected(view.error());
        frame.views.push_back(std::move(*view));
    }
    return frame;
}

}  // namespace

Expected<std::vector<CodecFrame>> simulated_frames(int num_instants) {
    SiteSceneOptions options;
    auto scene = SiteScene::create(options);
    if (!scene) return tl::unexpected(scene.error());
    auto pipeline = site_node::Pipeline::create(*scene, {}, {});
    if (!pipeline) return tl::unexpected(pipeline.error());
    std::vector<CodecFrame> frames;
    for (int i = 0; i < num_instants; ++i) {
        capture::Metaframe metaframe;
        const auto instant = static_cast<std::size_t>(i * options.num_instants / num_instants);
        for (std::size_t camera = 0; camera < scene->rig().cameras.size(); ++camera)
            metaframe.frames.push_back({camera, {}, scene->picture(instant, camera), nullptr});
        auto frame = make_frame("simulated room", scene->rig(), metaframe, *pipeline);
        if (!frame) return tl::unexpected(frame.error());
        frames.push_back(std::move(*frame));
    }
    return frames;
}

Expected<std::vector<CodecFrame>> recorded_frames(const std::filesystem::path& folder,
                                                  std::size_t num_views) {
    auto source = capture::RecordingSource::open({.folder = folder});
    if (!source) return tl::unexpected(source.error());
    const config::Rig& rig = (*source)->rig();
    std::vector<std::string> without;
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
        // the first camera of each run of cameras with the same place in 0 .. num_views - 1
        const std::size_t place = c * num_views / rig.cameras.size();
        if (c > 0 && (c - 1) * num_views / rig.cameras.size() == place)
            without.push_back(rig.cameras[c].name);
    }
    auto metaframe = (*source)->read_frame(0, without);
    if (!metaframe) return tl::unexpected(metaframe.error());
    auto pipeline = site_node::Pipeline::create(**source, {}, {});
    if (!pipeline) return tl::unexpected(pipeline.error());
    auto frame = make_frame(folder.filename().string(), rig, *metaframe, *pipeline);
    if (!frame) return tl::unexpected(frame.error());
    std::vector<CodecFrame> frames;
    frames.push_back(std::move(*frame));
    return frames;
}

}  // namespace atrium::bench
