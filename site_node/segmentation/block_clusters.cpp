#include "site_node/segmentation/block_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace atrium::segmentation {
namespace {

// Values of one block that look the same: within this many deviations, and never less than the
// steps of compression.
constexpr double kSameLook = 4.0;
constexpr int kMinLumaStep = 6;
constexpr int kMinChromaStep = 5;

struct Tolerance {
    int luma;
    int chroma;
};

struct Cluster {
    std::array<std::int32_t, 6> sum{};
    std::int32_t num = 0;
};

// Largest excess over the tolerance, in 1/256 of it; at most 256: the same look.
int difference(const Cluster& cluster, const BlockValue& value, const Tolerance& tolerance) {
    int most = 0;
    for (std::size_t i = 0; i < value.size(); ++i) {
        const int step = i < 4 ? tolerance.luma : tolerance.chroma;
        const int distance = std::abs(value[i] * cluster.num - cluster.sum[i]);
        most = std::max(most, 256 * distance / (step * cluster.num));
    }
    return most;
}

void add(const BlockValue& value, Cluster& cluster) {
    for (std::size_t i = 0; i < value.size(); ++i) cluster.sum[i] += value[i];
    ++cluster.num;
}

// Clusters of one block.
class BlockSorter {
public:
    explicit BlockSorter(const Tolerance& tolerance) : tolerance_(tolerance) {}

    void sort(std::span<const BlockValue> values, std::span<std::uint8_t> labels) {
        clusters_.clear();
        for (const BlockValue& value : values) collect(value);
        keep_most_frequent();
        // again from the means: the first pass depends on the order
        std::array<Cluster, BlockClusters::kMaxClusters> means{};
        std::copy(clusters_.begin(), clusters_.end(), means.begin());
        std::array<std::int32_t, BlockClusters::kMaxClusters> counts{};
        for (std::size_t i = 0; i < values.size(); ++i) {
            labels[i] = nearest({means.data(), clusters_.size()}, values[i]);
            if (labels[i] != BlockClusters::kNoCluster) ++counts[labels[i]];
        }
        rename_by_count(counts, labels);
    }

private:
    std::uint8_t nearest(std::span<const Cluster> clusters, const BlockValue& value) const {
        std::uint8_t best = BlockClusters::kNoCluster;
        int least = 257;
        for (std::size_t c = 0; c < clusters.size(); ++c) {
            const int far = difference(clusters[c], value, tolerance_);
            if (far < least) {
                least = far;
                best = static_cast<std::uint8_t>(c);
            }
        }
        return best;
    }

    void collect(const BlockValue& value) {
        constexpr std::size_t kMaxCollected = 24;
        const std::uint8_t best = nearest(clusters_, value);
        if (best != BlockClusters::kNoCluster) return add(value, clusters_[best]);
        if (clusters_.size() == kMaxCollected) {
            // makes room for a look that may become frequent later
            const auto rarest = std::min_element(
                clusters_.begin(), clusters_.end(), [](auto& a, auto& b) { return a.num < b.num; });
            clusters_.erase(rarest);
        }
        clusters_.emplace_back();
        add(value, clusters_.back());
    }

    void keep_most_frequent() {
        std::stable_sort(
            clusters_.begin(), clusters_.end(), [](auto& a, auto& b) { return a.num > b.num; });
        if (clusters_.size() > BlockClusters::kMaxClusters)
            clusters_.resize(BlockClusters::kMaxClusters);
    }

    static void rename_by_count(const std::array<std::int32_t, BlockClusters::kMaxClusters>& counts,
                                std::span<std::uint8_t> labels) {
        std::array<std::uint8_t, BlockClusters::kMaxClusters> order{};
        std::iota(order.begin(), order.end(), std::uint8_t{0});
        std::stable_sort(
            order.begin(), order.end(), [&](auto a, auto b) { return counts[a] > counts[b]; });
        std::array<std::uint8_t, BlockClusters::kMaxClusters> name{};
        for (std::uint8_t i = 0; i < order.size(); ++i) name[order[i]] = i;
        for (std::uint8_t& label : labels)
            if (label != BlockClusters::kNoCluster) label = name[label];
    }

    Tolerance tolerance_;
    std::vector<Cluster> clusters_;
};

// Noise of one sample, from the differences of successive pictures in the calmer half of places.
double estimate_noise(std::span<const image::YuvView> pictures) {
    constexpr int kStep = 8;  // of the places [px]
    std::vector<double> means;
    const image::YuvView& first = pictures.front();
    for (int y = 0; y < first.height(); y += kStep) {
        for (int x = 0; x < first.width(); x += kStep) {
            double sum = 0.0;
            for (std::size_t i = 1; i < pictures.size(); ++i)
                sum += std::abs(pictures[i].y.at(x, y) - pictures[i - 1].y.at(x, y));
            means.push_back(sum /
                            static_cast<double>(std::max<std::size_t>(pictures.size(), 2) - 1));
        }
    }
    const auto calm = means.begin() + static_cast<std::ptrdiff_t>(means.size() / 4);
    std::nth_element(means.begin(), calm, means.end());
    constexpr double kMeanDifference = 1.128;  // of two values with deviation 1
    return *calm / kMeanDifference;
}

std::uint16_t to_luma(double value) {
    return static_cast<std::uint16_t>(std::clamp(std::round(256.0 * value), 0.0, 65535.0));
}
std::int16_t to_chroma(double value, double one) {
    return static_cast<std::int16_t>(std::clamp(std::round(value * one), -32768.0, 32767.0));
}

struct BlockSums {
    std::array<double, 6> sum{};
    std::array<double, 4> luma_sq{};
    double uu = 0.0, uv = 0.0, vv = 0.0;
    int num = 0;

    void add(const BlockValue& value) {
        ++num;
        for (std::size_t i = 0; i < 4; ++i) {
            sum[i] += value[i];
            luma_sq[i] += value[i] * value[i];
        }
        const double u = value[4] - 128.0;
        const double v = value[5] - 128.0;
        sum[4] += u;
        sum[5] += v;
        uu += u * u;
        uv += u * v;
        vv += v * v;
    }
};

void store(const BlockSums& sums, int column, int row, BackgroundStatistics& room) {
    const double scale = 1.0 / sums.num;
    const auto width = static_cast<std::size_t>(room.width);
    const std::size_t top =
        2 * static_cast<std::size_t>(row) * width + 2 * static_cast<std::size_t>(column);
    const std::array<std::size_t, 4> pixels{top, top + 1, top + width, top + width + 1};
    for (std::size_t i = 0; i < 4; ++i) {
        const double mean = scale * sums.sum[i];
        const double sigma = std::sqrt(std::max(scale * sums.luma_sq[i] - mean * mean, 0.0));
        room.luma[pixels[i]] = to_luma(mean);
        room.luma_sigma[pixels[i]] =
            static_cast<std::uint8_t>(std::min(std::ceil(4.0 * sigma - 1e-3), 255.0));
    }
    const std::size_t block =
        static_cast<std::size_t>(row) * (width / 2) + static_cast<std::size_t>(column);
    const double u = scale * sums.sum[4];
    const double v = scale * sums.sum[5];
    room.u[block] = to_chroma(u, 128.0);
    room.v[block] = to_chroma(v, 128.0);
    room.uu[block] = to_chroma(scale * sums.uu - u * u, 16.0);
    room.uv[block] = to_chroma(scale * sums.uv - u * v, 16.0);
    room.vv[block] = to_chroma(scale * sums.vv - v * v, 16.0);
}

// Mean look of a rectangle of blocks: four lumas, u, v.
struct Look {
    double weight = 0.0;
    std::array<double, 6> sum{};
};

// Half as many columns and rows; each cell sums up four.
std::vector<Look> halved(const std::vector<Look>& fine, int columns, int rows) {
    const int half_columns = (columns + 1) / 2;
    std::vector<Look> coarse(static_cast<std::size_t>(half_columns) *
                             static_cast<std::size_t>((rows + 1) / 2));
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            const Look& from = fine[static_cast<std::size_t>(y * columns + x)];
            if (from.weight == 0.0) continue;
            Look& to = coarse[static_cast<std::size_t>(y / 2 * half_columns + x / 2)];
            // every cell counts alike: far places must not outweigh near ones
            to.weight += 1.0;
            for (std::size_t i = 0; i < to.sum.size(); ++i) to.sum[i] += from.sum[i] / from.weight;
        }
    }
    return coarse;
}

// Bilinear value of the coarser level for cells without a look.
void fill_from(const std::vector<Look>& coarse, int columns, int rows, std::vector<Look>& fine) {
    const int half_columns = (columns + 1) / 2;
    const int half_rows = (rows + 1) / 2;
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            Look& to = fine[static_cast<std::size_t>(y * columns + x)];
            if (to.weight > 0.0) continue;
            const double cx = std::clamp(x / 2.0 - 0.25, 0.0, half_columns - 1.0);
            const double cy = std::clamp(y / 2.0 - 0.25, 0.0, half_rows - 1.0);
            const int x0 = static_cast<int>(cx);
            const int y0 = static_cast<int>(cy);
            to.weight = 1.0;
            for (const int j : {0, 1}) {
                for (const int i : {0, 1}) {
                    const int sx = std::min(x0 + i, half_columns - 1);
                    const int sy = std::min(y0 + j, half_rows - 1);
                    const double share =
                        (i != 0 ? cx - x0 : 1.0 - cx + x0) * (j != 0 ? cy - y0 : 1.0 - cy + y0);
                    const Look& from = coarse[static_cast<std::size_t>(sy * half_columns + sx)];
                    for (std::size_t k = 0; k < to.sum.size(); ++k)
                        to.sum[k] += share * from.sum[k] / from.weight;
                }
            }
        }
    }
}

void fill_level(std::vector<Look>& level, int columns, int rows) {
    if (columns <= 1 && rows <= 1) {
        if (level[0].weight == 0.0) level[0] = {1.0, {128.0, 128.0, 128.0, 128.0, 0.0, 0.0}};
        return;
    }
    std::vector<Look> coarse = halved(level, columns, rows);
    fill_level(coarse, (columns + 1) / 2, (rows + 1) / 2);
    fill_from(coarse, columns, rows, level);
}

// At an edge, compression and a trembling camera change values more than noise does.
Tolerance tolerance_at(std::span<const image::YuvView> pictures,
                       int column,
                       int row,
                       const Tolerance& plain) {
    int least = 255;
    int most = 0;
    const image::PlaneView& luma = pictures[pictures.size() / 2].y;
    for (int y = std::max(2 * row - 1, 0); y < std::min(2 * row + 3, luma.height); ++y) {
        for (int x = std::max(2 * column - 1, 0); x < std::min(2 * column + 3, luma.width); ++x) {
            least = std::min<int>(least, luma.at(x, y));
            most = std::max<int>(most, luma.at(x, y));
        }
    }
    constexpr int kShare = 5;  // of the contrast nearby
    return {plain.luma + (most - least) / kShare, plain.chroma + (most - least) / (2 * kShare)};
}

}  // namespace

BlockValue block_value(const image::YuvView& picture, int column, int row) {
    const std::uint8_t* const top = picture.y.row(2 * row) + 2 * column;
    const std::uint8_t* const bottom = picture.y.row(2 * row + 1) + 2 * column;
    return {
        top[0], top[1], bottom[0], bottom[1], picture.u.at(column, row), picture.v.at(column, row)};
}

BlockClusters find_clusters(std::span<const image::YuvView> pictures) {
    BlockClusters found;
    found.columns = pictures.front().width() / 2;
    found.rows = pictures.front().height() / 2;
    found.luma_noise = estimate_noise(pictures);
    const Tolerance tolerance{
        std::max(kMinLumaStep, static_cast<int>(std::lround(kSameLook * found.luma_noise))),
        std::max(kMinChromaStep, static_cast<int>(std::lround(kSameLook / 2 * found.luma_noise)))};
    found.labels.assign(pictures.size(), std::vector<std::uint8_t>(found.num_blocks()));
    std::vector<BlockValue> values(pictures.size());
    std::vector<std::uint8_t> labels(pictures.size());
    for (int row = 0; row < found.rows; ++row) {
        for (int column = 0; column < found.columns; ++column) {
            for (std::size_t i = 0; i < pictures.size(); ++i)
                values[i] = block_value(pictures[i], column, row);
            BlockSorter sorter(tolerance_at(pictures, column, row, tolerance));
            sorter.sort(values, labels);
            const auto block = static_cast<std::size_t>(row * found.columns + column);
            for (std::size_t i = 0; i < pictures.size(); ++i) found.labels[i][block] = labels[i];
        }
    }
    return found;
}

BackgroundStatistics statistics_of(std::span<const image::YuvView> pictures,
                                   const BlockClusters& clusters,
                                   std::span<const std::uint8_t> chosen) {
    BackgroundStatistics room;
    room.width = 2 * clusters.columns;
    room.height = 2 * clusters.rows;
    room.mosaic = pictures.front().mosaic;
    room.num_frames = static_cast<int>(pictures.size());
    room.luma.resize(4 * clusters.num_blocks());
    room.luma_sigma.resize(room.luma.size());
    for (auto* plane : {&room.u, &room.v, &room.uu, &room.uv, &room.vv})
        plane->resize(clusters.num_blocks());
    for (int row = 0; row < clusters.rows; ++row) {
        for (int column = 0; column < clusters.columns; ++column) {
            const auto block = static_cast<std::size_t>(row * clusters.columns + column);
            if (chosen[block] == BlockClusters::kNoCluster) continue;
            BlockSums sums;
            for (std::size_t i = 0; i < pictures.size(); ++i) {
                if (clusters.labels[i][block] == chosen[block])
                    sums.add(block_value(pictures[i], column, row));
            }
            if (sums.num > 0) store(sums, column, row, room);
        }
    }
    return room;
}

void fill_unknown(std::span<const std::uint8_t> unknown, BackgroundStatistics& room) {
    const int columns = room.width / 2;
    const int rows = room.height / 2;
    const auto width = static_cast<std::size_t>(room.width);
    std::vector<Look> looks(unknown.size());
    const auto pixels_of = [&](std::size_t block) {
        const std::size_t top = block / (width / 2) * 2 * width + block % (width / 2) * 2;
        return std::array<std::size_t, 4>{top, top + 1, top + width, top + width + 1};
    };
    for (std::size_t block = 0; block < unknown.size(); ++block) {
        if (unknown[block] != 0) continue;
        looks[block].weight = 1.0;
        std::size_t i = 0;
        for (const std::size_t pixel : pixels_of(block))
            looks[block].sum[i++] = room.luma[pixel] / 256.0;
        looks[block].sum[4] = room.u[block] / 128.0;
        looks[block].sum[5] = room.v[block] / 128.0;
    }
    fill_level(looks, columns, rows);
    for (std::size_t block = 0; block < unknown.size(); ++block) {
        if (unknown[block] == 0) continue;
        std::size_t i = 0;
        for (const std::size_t pixel : pixels_of(block)) {
            room.luma[pixel] = to_luma(looks[block].sum[i++]);
            room.luma_sigma[pixel] = 0;
        }
        room.u[block] = to_chroma(looks[block].sum[4], 128.0);
        room.v[block] = to_chroma(looks[block].sum[5], 128.0);
        room.uu[block] = room.uv[block] = room.vv[block] = 0;
    }
}

}  // namespace atrium::segmentation
