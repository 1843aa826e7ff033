#include "tools/calibrate/sweep/detect_lights.hpp"

#include "core/geometry/alignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

namespace atrium::calibrate {
namespace {

constexpr int kBlock_px = 16;            // looked at as a whole
constexpr double kAboveNoise = 8.0;      // standard deviations
constexpr double kLeastThreshold = 6.0;  // [grey levels] codecs make rings of some levels
constexpr double kLeastNoise = 0.5;      // [grey levels] of rounding
// Two values of a normal distribution differ less if both are above its mean.
constexpr double kCutOff = 1.67;
constexpr double kOfStrongest = 0.1;    // a light has this share of the strongest one's contrast
constexpr double kCentroidLevel = 0.2;  // of the contrast: pixels above it count
constexpr double kHalf = 0.5, kThreeQuarters = 0.75;
constexpr std::size_t kMostPixels = 4096;  // of a light with its halo
constexpr double kMostWidth_px = 18.0;
constexpr double kMostLength_px = 60.0;
constexpr std::size_t kFewestPixels = 3;        // above a quarter of the contrast
constexpr std::size_t kFewestMosaicPixels = 5;  // one hot sample fills four blocks
constexpr double kLeastFilled = 0.6;            // of the ellipse of the same moments
constexpr int kRing_px = 3;                     // around a bright area: its background

// True if one of 16 bytes is above `limit`.
bool any_above(const std::uint8_t* bytes, int limit) {
    constexpr std::uint64_t kOnes = 0x0101010101010101ULL;
    constexpr std::uint64_t kHigh = 0x8080808080808080ULL;
    const int low = limit & 0x7F;
    std::uint64_t above = 0;
    for (const int half : {0, 8}) {
        std::uint64_t v = 0;
        std::memcpy(&v, bytes + half, sizeof(v));
        const std::uint64_t sum = (v & ~kHigh) + kOnes * static_cast<std::uint64_t>(0x7F - low);
        above |= limit < 0x80 ? (sum | v) & kHigh : sum & v & kHigh;
    }
    return above != 0;
}

template <std::size_t N>
int median_of_counts(const std::array<std::uint32_t, N>& counts, std::uint32_t total) {
    std::uint32_t sum = 0;
    for (std::size_t value = 0; value < N; ++value) {
        sum += counts[value];
        if (2 * sum >= total) return static_cast<int>(value);
    }
    return 0;
}

// Standard deviation of values whose pairs have these differences; 0 if there are few.
double noise_of(const std::array<std::uint32_t, 256>& differences, std::uint32_t total) {
    constexpr std::uint32_t kFewestPairs = 64;
    constexpr double kMedianOfNormal = 0.6745;
    if (total < kFewestPairs) return 0.0;
    // between the two nearest whole numbers, by the counts: half a level matters
    const int middle = median_of_counts(differences, total);
    double below = 0.0;
    for (int d = 0; d < middle; ++d) below += differences[static_cast<std::size_t>(d)];
    const double inside = differences[static_cast<std::size_t>(middle)];
    const double median = middle - 0.5 + (0.5 * total - below) / inside;
    return median / (kMedianOfNormal * std::numbers::sqrt2);
}

}  // namespace

// Of a sixteenth of the pixels. The noise is that of neighbours' differences, which gradients of
// the light hardly change; neighbours of one colour in a mosaic are two pixels apart. Where the
// sensor cuts the noise off at black, only pairs above it tell something, and less than the whole.
void LightDetector::measure_background(const image::PlaneView& picture,
                                       DetectedLights& found) const {
    std::array<std::uint32_t, 256> values{}, all{}, above_black{};
    std::uint32_t total = 0, num_above_black = 0;
    for (int y = 1; y < picture.height; y += 4) {
        const std::uint8_t* row = picture.row(y);
        for (int x = 0; x + 2 < picture.width; x += 4) {
            const auto difference = static_cast<std::size_t>(std::abs(row[x] - row[x + 2]));
            ++values[row[x]];
            ++all[difference];
            ++total;
            if (row[x] == 0 || row[x + 2] == 0) continue;
            ++above_black[difference];
            ++num_above_black;
        }
    }
    found.background = median_of_counts(values, total);
    const bool is_cut_off = 5 * values[0] > total;
    found.noise =
        is_cut_off ? kCutOff * noise_of(above_black, num_above_black) : noise_of(all, total);
    found.noise = std::max(kLeastNoise, found.noise);
    found.threshold = options_.threshold > 0.0
                          ? options_.threshold
                          : std::max(kLeastThreshold, kAboveNoise * found.noise);
}

std::size_t LightDetector::fewest_pixels() const {
    return is_mosaic_ ? kFewestMosaicPixels : kFewestPixels;
}

float LightDetector::value_at(const image::PlaneView& picture, int x, int y) const {
    if (!is_mosaic_) return picture.row(y)[x];
    const std::uint8_t* row = picture.row(y);
    const std::uint8_t* next = picture.row(std::min(y + 1, picture.height - 1));
    const int right = std::min(x + 1, picture.width - 1);
    return 0.25F * static_cast<float>(row[x] + row[right] + next[x] + next[right]);
}

void LightDetector::detect(const image::YuvView& view, DetectedLights& found) {
    const image::PlaneView& picture = view.y;
    found = {};
    is_mosaic_ = view.mosaic != image::Mosaic::kNone;
    width_ = picture.width;
    height_ = picture.height;
    const std::size_t num_pixels =
        static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    if (visited_.size() != num_pixels) visited_.assign(num_pixels, 0);
    measure_background(picture, found);
    // a mosaic's blocks reach a quarter of a coloured light's sample
    const double above =
        is_mosaic_ ? std::max(kLeastThreshold, found.threshold / 2.0) : found.threshold;
    limit_ = std::min(255, static_cast<int>(found.background + above));
    grow_ = static_cast<float>(std::min(found.background + 0.5 * above, limit_ - 0.5));
    for (int y0 = 0; y0 < height_; y0 += kBlock_px) {
        const int rows = std::min(kBlock_px, height_ - y0);
        for (int x0 = 0; x0 < width_; x0 += kBlock_px) {
            // the last block of a row overlaps the one before
            const int x = std::max(0, std::min(x0, width_ - kBlock_px));
            bool is_bright = width_ < kBlock_px;
            for (int y = y0; y < y0 + rows && !is_bright; ++y)
                is_bright = any_above(picture.row(y) + x, limit_);
            if (is_bright) find_in_block(picture, x, y0, found);
        }
    }
    for (const std::uint32_t pixel : dirty_) visited_[pixel] = 0;
    dirty_.clear();
    std::ranges::stable_sort(found.lights, std::ranges::greater{}, &DetectedLight::contrast);
    const double least = found.lights.empty() || options_.threshold > 0.0
                             ? 0.0
                             : kOfStrongest * found.lights.front().contrast;
    std::erase_if(found.lights, [&](const DetectedLight& l) { return l.contrast < least; });
    if (found.lights.size() > kMostLights) found.lights.resize(kMostLights);
}

void LightDetector::find_in_block(const image::PlaneView& picture,
                                  int x0,
                                  int y0,
                                  DetectedLights& found) {
    for (int y = y0; y < std::min(y0 + kBlock_px, height_); ++y) {
        for (int x = x0; x < std::min(x0 + kBlock_px, width_); ++x) {
            if (visited_[static_cast<std::size_t>(y * width_ + x)] != 0 ||
                value_at(picture, x, y) <= static_cast<float>(limit_))
                continue;
            flood(picture, x, y);
            if (area_size_ > kMostPixels) {
                ++found.num_large;
            } else {
                examine(picture, found);
            }
        }
    }
}

// Collects the bright pixels that are connected with (x, y), over corners, too: down to half of
// what begins an area, because a faint streak is above that in parts only.
void LightDetector::flood(const image::PlaneView& picture, int x, int y) {
    area_.clear();
    area_size_ = 0;
    stack_.clear();
    const auto visit = [&](int px, int py) {
        const std::size_t at = static_cast<std::size_t>(py * width_ + px);
        if (visited_[at] != 0) return;
        const float value = value_at(picture, px, py);
        if (value <= grow_) return;
        visited_[at] = 1;
        dirty_.push_back(static_cast<std::uint32_t>(at));
        stack_.emplace_back(px, py);
        if (++area_size_ <= kMostPixels) area_.push_back({px, py, value});
    };
    visit(x, y);
    while (!stack_.empty()) {
        const auto [px, py] = stack_.back();
        stack_.pop_back();
        for (int ny = std::max(0, py - 1); ny <= std::min(height_ - 1, py + 1); ++ny)
            for (int nx = std::max(0, px - 1); nx <= std::min(width_ - 1, px + 1); ++nx)
                visit(nx, ny);
    }
}

// Median of the pixels some way outside of the area.
double LightDetector::ring_background(const image::PlaneView& picture) const {
    int left = width_, right = 0, top = height_, bottom = 0;
    for (const Bright& pixel : area_) {
        left = std::min(left, pixel.x);
        right = std::max(right, pixel.x);
        top = std::min(top, pixel.y);
        bottom = std::max(bottom, pixel.y);
    }
    left = std::max(0, left - kRing_px);
    top = std::max(0, top - kRing_px);
    right = std::min(width_ - 1, right + kRing_px);
    bottom = std::min(height_ - 1, bottom + kRing_px);
    std::array<std::uint32_t, 1024> counts{};
    std::uint32_t total = 0;
    const auto add = [&](int x, int y) {
        const float value = value_at(picture, x, y);
        if (value > grow_) return;  // of another area
        ++counts[static_cast<std::size_t>(4.0F * value)];
        ++total;
    };
    for (int k = 0; k < 2; ++k) {  // two pixels wide
        for (int x = left; x <= right; ++x) {
            add(x, std::min(top + k, bottom));
            add(x, std::max(bottom - k, top));
        }
        for (int y = top; y <= bottom; ++y) {
            add(std::min(left + k, right), y);
            add(std::max(right - k, left), y);
        }
    }
    return total == 0 ? static_cast<double>(grow_) : median_of_counts(counts, total) / 4.0;
}

// The connected parts of the area above a level.
std::vector<std::vector<LightDetector::Bright>> LightDetector::parts_above(double level) const {
    std::vector<Bright> left;
    for (const Bright& pixel : area_)
        if (pixel.value > level) left.push_back(pixel);
    std::ranges::sort(left, {}, [](const Bright& p) { return std::pair(p.y, p.x); });
    const auto index_of = [&](int x, int y) -> std::size_t {
        const auto found = std::ranges::lower_bound(
            left, std::pair(y, x), {}, [](const Bright& p) { return std::pair(p.y, p.x); });
        const bool is_it = found != left.end() && found->x == x && found->y == y;
        return is_it ? static_cast<std::size_t>(found - left.begin()) : left.size();
    };
    std::vector<std::vector<Bright>> parts;
    std::vector<std::uint8_t> is_done(left.size(), 0);
    std::vector<std::size_t> open;
    for (std::size_t first = 0; first < left.size(); ++first) {
        if (is_done[first] != 0) continue;
        std::vector<Bright>& part = parts.emplace_back();
        open.assign(1, first);
        is_done[first] = 1;
        while (!open.empty()) {
            const Bright pixel = left[open.back()];
            open.pop_back();
            part.push_back(pixel);
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    const std::size_t next = index_of(pixel.x + dx, pixel.y + dy);
                    if (next == left.size() || is_done[next] != 0) continue;
                    is_done[next] = 1;
                    open.push_back(next);
                }
            }
        }
    }
    return parts;
}

void LightDetector::examine(const image::PlaneView& picture, DetectedLights& found) {
    const float brightest = std::ranges::max(area_, {}, &Bright::value).value;
    const double background = ring_background(picture);
    const double contrast = brightest - background;
    const auto halves = parts_above(background + kHalf * contrast);
    const double floor =
        std::max({kCentroidLevel * contrast, 2.5 * found.noise, grow_ - background});
    for (const std::vector<Bright>& spot : parts_above(background + floor)) {
        const float peak = std::ranges::max(spot, {}, &Bright::value).value;
        if (peak - background < kHalf * contrast) continue;  // of a halo
        std::vector<const std::vector<Bright>*> inside;
        for (const std::vector<Bright>& half : halves) {
            const bool is_inside = std::ranges::any_of(spot, [&](const Bright& pixel) {
                return pixel.x == half.front().x && pixel.y == half.front().y;
            });
            if (is_inside && half.size() >= fewest_pixels()) inside.push_back(&half);
        }
        if (inside.size() < 2) {
            take_spot(spot, background + floor, peak - background, found);
            continue;
        }
        // lights whose halos touch: each above the valley between them
        for (const std::vector<Bright>* half : inside) {
            const float top = std::ranges::max(*half, {}, &Bright::value).value;
            take_spot(*half, background + kHalf * contrast, top - background, found);
        }
    }
}

// Judges a spot, whose pixels are all above `floor`, and keeps its centroid.
void LightDetector::take_spot(const std::vector<Bright>& spot,
                              double floor,
                              double contrast,
                              DetectedLights& found) const {
    const float peak = std::ranges::max(spot, {}, &Bright::value).value;
    const double half_level = std::max(floor, peak - kHalf * contrast);
    const double quarter_level = std::max(floor, peak - kThreeQuarters * contrast);
    std::size_t num_quarter = 0;
    double weight = 0.0, num_half = 0.0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero(), half_sum = Eigen::Vector2d::Zero();
    Eigen::Matrix2d half_squares = Eigen::Matrix2d::Zero();
    const Eigen::Vector2d origin(spot.front().x, spot.front().y);
    for (const Bright& pixel : spot) {
        if (pixel.x == 0 || pixel.y == 0 || pixel.x >= width_ - 2 || pixel.y >= height_ - 2)
            return;  // the rest may be outside
        const Eigen::Vector2d at = Eigen::Vector2d(pixel.x, pixel.y) - origin;
        const double above = pixel.value - floor;
        weight += above;
        sum += above * at;
        num_quarter += pixel.value >= quarter_level ? 1 : 0;
        if (pixel.value < half_level) continue;
        num_half += 1.0;
        half_sum += at;
        half_squares += at * at.transpose();
    }
    if (num_quarter < fewest_pixels()) {
        ++found.num_specks;
        return;
    }
    const Eigen::Vector2d mean = half_sum / num_half;
    // a pixel is a square, not a point
    const Eigen::Matrix2d spread =
        half_squares / num_half - mean * mean.transpose() + Eigen::Matrix2d::Identity() / 12.0;
    const Eigen::Vector2d deviations = geometry::eigenvalues_of(spread).cwiseMax(0.0).cwiseSqrt();
    DetectedLight light;
    light.width_px = 4.0 * deviations[0];                                         // of a disc
    light.length_px = std::max(light.width_px, std::sqrt(12.0) * deviations[1]);  // of a streak
    const double ellipse = 4.0 * std::numbers::pi * deviations[0] * deviations[1];
    if (light.width_px > kMostWidth_px || light.length_px > kMostLength_px ||
        num_half < kLeastFilled * ellipse) {
        ++found.num_large;
        return;
    }
    light.px = origin + sum / weight;
    if (is_mosaic_) light.px += Eigen::Vector2d(0.5, 0.5);  // of a block's middle
    light.contrast = contrast;
    found.lights.push_back(light);
}

}  // namespace atrium::calibrate
