#include "tests/support/pictures/filmed_person.hpp"

#include "core/codec/texture_codec.hpp"
#include "simulation/room_renderer.hpp"
#include "site_node/capture/recording_source.hpp"
#include "site_node/hull/corner_rounding.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/refine/photo_refinement.hpp"
#include "site_node/silhouette/silhouette.hpp"
#include "site_node/texture/texture.hpp"
#include "tests/support/pictures/bgr_from_yuv.hpp"
#include "tests/support/shapes/bounding_rect.hpp"

#include <utility>

namespace atrium::test {
namespace {

constexpr int kSiteJpegQuality = 86;  // of site_node::PipelineOptions

Expected<TruePicture> true_picture(const geometry::CalibratedCamera& camera,
                                   const capture::CameraFrame& frame) {
    if (frame.image.empty() || frame.silhouette == nullptr)
        return make_error(ErrorKind::kNotFound, camera.name + ": no picture or no mask");
    TruePicture out;
    out.camera = camera;
    image::YuvImage buffer;
    const image::YuvView view = image::working_view(frame.image, buffer);
    out.bgr = test::bgr_from_yuv(view);
    image::yuv_from_bgr(out.bgr.data(),
                        view.width(),
                        view.height(),
                        static_cast<std::size_t>(view.width()) * 3,
                        out.yuv);
    out.mask = *frame.silhouette;
    return out;
}

Expected<renderer::CameraPicture> coded_picture(const TruePicture& from,
                                                const image::PixelRect& subject,
                                                texture::Resolution resolution) {
    texture::TextureScratch scratch;
    codec::TextureCrop crop;
    codec::CodedTexture coded;
    codec::DecodedTexture decoded;
    codec::TextureEncoder encoder;
    codec::TextureDecoder decoder;
    if (!texture::crop_texture(
            from.yuv, from.mask, subject, {.resolution = resolution}, scratch, crop))
        return make_error(ErrorKind::kInvalidData, from.camera.name + " sees nobody");
    if (auto ok = encoder.encode(crop, kSiteJpegQuality, coded); !ok)
        return tl::unexpected(ok.error());
    if (auto ok = decoder.decode(coded.colour, coded.mask, decoded); !ok)
        return tl::unexpected(ok.error());
    return renderer::CameraPicture{
        from.camera, crop.crop_px, decoded.width, decoded.height, std::move(decoded.rgba)};
}

renderer::CameraPicture whole_picture(const TruePicture& from, const image::PixelRect& subject) {
    renderer::CameraPicture out{from.camera, subject, subject.width, subject.height, {}};
    for (int y = subject.y; y < subject.y + subject.height; ++y) {
        for (int x = subject.x; x < subject.x + subject.width; ++x) {
            const std::uint8_t* bgr =
                from.bgr.data() + 3 * (static_cast<std::ptrdiff_t>(y) * from.width() + x);
            for (const std::uint8_t value : {bgr[2], bgr[1], bgr[0], from.mask.at(x, y)})
                out.rgba.push_back(value);
        }
    }
    return out;
}

}  // namespace

Refinement refinement_named(std::string_view name) {
    if (name == "photo") return Refinement::kPhoto;
    if (name == "round_photo") return Refinement::kRoundPhoto;
    return name == "round" ? Refinement::kRound : Refinement::kOff;
}

Expected<std::vector<TruePicture>> film_room(const std::vector<geometry::CalibratedCamera>& cameras,
                                             const simulation::RoomOptions& options,
                                             double time_s) {
    auto room = simulation::RoomRenderer::create(cameras, options);
    if (!room) return tl::unexpected(room.error());
    std::vector<TruePicture> pictures(cameras.size());
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        TruePicture& picture = pictures[i];
        picture.camera = cameras[i];
        room->render(time_s, i, simulation::Scene::kPerson, 0, picture.yuv, &picture.mask);
        picture.bgr = test::bgr_from_yuv(picture.yuv);
    }
    return pictures;
}

Expected<std::vector<TruePicture>> load_pictures(const std::filesystem::path& recording) {
    auto source = capture::RecordingSource::open({.folder = recording});
    if (!source) return tl::unexpected(source.error());
    const auto metaframe = (*source)->read_frame(0);
    if (!metaframe) return tl::unexpected(metaframe.error());
    std::vector<TruePicture> pictures;
    for (const capture::CameraFrame& frame : metaframe->frames) {
        auto picture = true_picture((*source)->rig().cameras[frame.camera], frame);
        if (!picture) return tl::unexpected(picture.error());
        pictures.push_back(std::move(*picture));
    }
    return pictures;
}

Expected<ReceivedPerson> receive_person(std::span<const TruePicture> pictures,
                                        Publishing publishing,
                                        Refinement refinement) {
    ReceivedPerson person;
    std::vector<hull::SilhouetteView> views;
    silhouette::SilhouetteScratch scratch;
    std::vector<silhouette::SilhouettePolygon> polygons;
    for (const TruePicture& picture : pictures) {
        const geometry::CalibratedCamera& camera = picture.camera;
        silhouette::extract_silhouette(picture.mask, camera.intrinsics, {}, scratch, polygons);
        hull::SilhouetteView view{camera.intrinsics, camera.camera_from_site, {}, {}};
        for (const auto& polygon : polygons) view.contours.push_back(polygon.vertices_px);
        views.push_back(std::move(view));
        const image::PixelRect subject = bounding_rect(picture.mask);
        if (publishing == Publishing::kAsTheyWere) {
            person.pictures.push_back(whole_picture(picture, subject));
            continue;
        }
        auto coded = coded_picture(picture,
                                   subject,
                                   publishing == Publishing::kFull ? texture::Resolution::kFull
                                                                   : texture::Resolution::kHalf);
        if (!coded) return tl::unexpected(coded.error());
        person.pictures.push_back(std::move(*coded));
    }
    hull::HullScratch hull_scratch;
    hull::VisualHull hull = hull::compute_visual_hull(views, {}, hull_scratch);
    if (hull.status != hull::HullStatus::kOk)
        return make_error(ErrorKind::kInvalidData, hull::to_string(hull.status));
    person.mesh = std::move(hull.mesh);
    if (refinement == Refinement::kRound || refinement == Refinement::kRoundPhoto) {
        std::vector<const hull::SilhouetteView*> pointers;
        for (const hull::SilhouetteView& view : views) pointers.push_back(&view);
        hull::CornerRounding().round(person.mesh, pointers);
    }
    if (refinement == Refinement::kPhoto || refinement == Refinement::kRoundPhoto) {
        std::vector<refine::PictureView> seen;
        for (const TruePicture& picture : pictures) {
            const image::PixelRect subject = bounding_rect(picture.mask);
            seen.push_back({&picture.camera, picture.yuv, &picture.mask, subject});
        }
        SerialExecutor executor;
        refine::PhotoRefinement().refine(person.mesh, seen, executor);
    }
    return person;
}

}  // namespace atrium::test
