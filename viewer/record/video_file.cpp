#include "viewer/record/video_file.hpp"

#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include <string>

namespace atrium::viewer {
namespace {

Error no_file(const VideoFormat& format, const std::string& reason) {
    return {ErrorKind::kUnavailable, "cannot write video " + format.file.string() + reason};
}

class Mpeg4Video : public VideoFile {
public:
    explicit Mpeg4Video(const VideoFormat& format) : width_(format.width), height_(format.height) {}
    static Expected<std::unique_ptr<VideoFile>> create(const VideoFormat& format) {
        auto self = std::make_unique<Mpeg4Video>(format);
        try {
            self->writer_.open(format.file.string(),
                               cv::VideoWriter::fourcc('m', 'p', '4', 'v'),
                               format.fps,
                               cv::Size(format.width, format.height));
        } catch (const cv::Exception& error) {
            return tl::unexpected(no_file(format, std::string(": ") + error.what()));
        }
        if (!self->writer_.isOpened()) return tl::unexpected(no_file(format, ""));
        return self;
    }
    Expected<void> set(std::span<const std::uint8_t> rgba) override {
        const cv::Mat picture(
            height_, width_, CV_8UC4, const_cast<std::uint8_t*>(rgba.data()));  // only read
        cv::cvtColor(picture, bgr_, cv::COLOR_RGBA2BGR);
        return {};
    }
    Expected<void> write() override {
        writer_.write(bgr_);
        return {};
    }
    Expected<void> finish() override {
        writer_.release();
        return {};
    }

private:
    int width_;
    int height_;
    cv::VideoWriter writer_;
    cv::Mat bgr_;
};

}  // namespace

Expected<std::unique_ptr<VideoFile>> create_video_file(const VideoFormat& format) {
    return format.file.extension() == ".mp4" ? Mpeg4Video::create(format)
                                             : create_jpeg_video(format);
}

}  // namespace atrium::viewer
