// SPDX-License-Identifier: Apache-2.0
// Reads Radiance .hdr pictures: RGBE, flat or run-length encoded, all eight orientations.
//
// The resolution line names the slow axis first; a minus sign on Y, or a plus on X, is
// the usual top-left origin. ATRIUM's files say "+X w -Y h": columns first.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "io/codecs.hpp"
#include "io/transfer.hpp"

namespace sateen::io {
namespace {

// A run of 127 equal bytes takes two.
constexpr std::uint64_t kMaxRatio = 64;

std::string_view as_text(Bytes bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool matches(Bytes bytes) {
    return as_text(bytes).substr(0, 2) == "#?";
}

/// One scan line runs along the fast axis.
struct Picture {
    bool columns_first = false;  ///< scan lines are columns
    bool flip_rows = false;      ///< the first row stored is the bottom
    bool flip_cols = false;      ///< the first column stored is the right
    std::size_t rows = 0;
    std::size_t cols = 0;
    Bytes pixels;
};

struct Axis {
    char sign = 0;
    char name = 0;
    std::size_t size = 0;
};

/// Takes "+X 256" off `line`.
std::optional<Axis> take_axis(std::string_view& line) {
    while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
    if (line.size() < 4 || line[2] != ' ') return std::nullopt;
    Axis axis{line[0], line[1], 0};
    line.remove_prefix(3);
    while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
    const auto [rest, code] =
        std::from_chars(line.data(), line.data() + line.size(), axis.size);
    if (code != std::errc() || (axis.sign != '+' && axis.sign != '-'))
        return std::nullopt;
    line.remove_prefix(static_cast<std::size_t>(rest - line.data()));
    return axis;
}

/// Takes a line off the front of `bytes`; nothing at a truncated header.
std::optional<std::string_view> take_line(Bytes& bytes) {
    const std::string_view text = as_text(bytes);
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return std::nullopt;
    bytes = bytes.subspan(end + 1);
    std::string_view line = text.substr(0, end);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
}

Result<Picture> parse_header(Bytes bytes, std::string_view name) {
    const std::size_t file_bytes = bytes.size();
    for (;;) {
        const auto line = take_line(bytes);
        if (!line) return bad_format(name, "truncated Radiance header");
        if (line->empty()) break;
        if (line->substr(0, 7) == "FORMAT=" && *line != "FORMAT=32-bit_rle_rgbe")
            return unsupported(name, "found " + std::string(*line) +
                                         ", expected FORMAT=32-bit_rle_rgbe");
    }
    const auto resolution = take_line(bytes);
    if (!resolution) return bad_format(name, "truncated Radiance header");
    std::string_view rest = *resolution;
    const auto slow = take_axis(rest);
    const auto fast = slow ? take_axis(rest) : std::nullopt;
    const bool columns_first = slow && slow->name == 'X';
    if (!slow || !fast || slow->name == fast->name ||
        (slow->name != 'X' && slow->name != 'Y') ||
        (fast->name != 'X' && fast->name != 'Y'))
        return bad_format(name, "found the resolution '" +
                                    std::string(resolution->substr(0, 40)) +
                                    "', expected one like '-Y 256 +X 256'");
    const Axis& x = columns_first ? *slow : *fast;
    const Axis& y = columns_first ? *fast : *slow;
    SATEEN_CHECK(check_size(name, y.size, x.size, file_bytes, kMaxRatio));
    return Picture{columns_first, y.sign == '+', x.sign == '-', y.size, x.size, bytes};
}

/// A scan line of planes R, G, B, E, each of the length of the line.
class LineReader {
  public:
    LineReader(Bytes bytes, std::size_t length)
        : bytes_(bytes), length_(length), line_(4 * length) {}

    [[nodiscard]] const std::uint8_t* component(std::size_t k) const {
        return line_.data() + k * length_;
    }

    [[nodiscard]] bool next() {
        constexpr std::size_t kMinRun = 8;
        constexpr std::size_t kMaxRun = 0x7FFF;
        if (length_ >= kMinRun && length_ <= kMaxRun && bytes_.size() >= 4 &&
            bytes_[0] == 2 && bytes_[1] == 2 && bytes_[2] < 128) {
            if ((std::size_t{bytes_[2]} << 8 | bytes_[3]) != length_) return false;
            bytes_ = bytes_.subspan(4);
            for (std::size_t k = 0; k < 4; ++k)
                if (!next_component(line_.data() + k * length_)) return false;
            return true;
        }
        return next_flat();
    }

  private:
    /// Runs: a count above 128, then the byte repeated; otherwise that many bytes.
    bool next_component(std::uint8_t* out) {
        for (std::size_t done = 0; done < length_;) {
            if (bytes_.size() < 2) return false;
            const std::size_t code = bytes_[0];
            const bool run = code > 128;
            const std::size_t count = run ? code - 128 : code;
            const std::size_t used = run ? 2 : 1 + count;
            if (count == 0 || count > length_ - done || used > bytes_.size())
                return false;
            if (run)
                std::fill_n(out + done, count, bytes_[1]);
            else
                std::copy_n(bytes_.data() + 1, count, out + done);
            bytes_ = bytes_.subspan(used);
            done += count;
        }
        return true;
    }

    /// Pixels one by one; the pixel (1, 1, 1, n) repeats the one before n times, and
    /// further such pixels count in higher digits of base 256.
    bool next_flat() {
        unsigned shift = 0;
        for (std::size_t done = 0; done < length_;) {
            if (bytes_.size() < 4) return false;
            const std::array<std::uint8_t, 4> pixel = {bytes_[0], bytes_[1], bytes_[2],
                                                       bytes_[3]};
            bytes_ = bytes_.subspan(4);
            if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
                if (done == 0 || shift > 16) return false;
                const std::size_t count = std::size_t{pixel[3]} << shift;
                if (count > length_ - done) return false;
                for (std::size_t k = 0; k < 4; ++k) {
                    std::uint8_t* const plane = line_.data() + k * length_;
                    std::fill_n(plane + done, count, plane[done - 1]);
                }
                done += count;
                shift += 8;
                continue;
            }
            for (std::size_t k = 0; k < 4; ++k) line_[k * length_ + done] = pixel[k];
            ++done;
            shift = 0;
        }
        return true;
    }

    Bytes bytes_;
    std::size_t length_;
    std::vector<std::uint8_t> line_;
};

/// v = (m + 1/2) 2^(e - 136) as Radiance itself reads it; e = 0 is black.
std::array<float, 256> exponent_table() {
    std::array<float, 256> table = {};
    for (int e = 1; e < 256; ++e)
        table[static_cast<std::size_t>(e)] = std::ldexp(1.0F, e - 136);
    return table;
}

Result<ImageHeader> read_radiance_header(Bytes bytes, std::string_view name) {
    SATEEN_TRY(const Picture picture, parse_header(bytes, name));
    ImageHeader header;
    header.rows = picture.rows;
    header.cols = picture.cols;
    header.bands = 3;
    header.bits = 32;
    header.floating_point = true;
    header.format = "Radiance";
    return header;
}

Result<Image> decode_radiance(Bytes bytes, std::string_view name, Encoding encoding) {
    SATEEN_TRY(const Picture picture, parse_header(bytes, name));
    const std::array<float, 256> scale = exponent_table();
    const std::size_t lines = picture.columns_first ? picture.cols : picture.rows;
    const std::size_t length = picture.columns_first ? picture.rows : picture.cols;
    LineReader reader(picture.pixels, length);
    Image image(3, picture.rows, picture.cols);
    for (std::size_t line = 0; line < lines; ++line) {
        if (!reader.next())
            return bad_format(name, "damaged or truncated Radiance picture: line " +
                                        std::to_string(line) + " of " +
                                        std::to_string(lines));
        const std::uint8_t* const exponents = reader.component(3);
        for (std::size_t band = 0; band < 3; ++band) {
            const std::uint8_t* const mantissas = reader.component(band);
            const PlaneView<float> plane = image.plane(band);
            for (std::size_t i = 0; i < length; ++i) {
                std::size_t row = picture.columns_first ? i : line;
                std::size_t col = picture.columns_first ? line : i;
                if (picture.flip_rows) row = picture.rows - 1 - row;
                if (picture.flip_cols) col = picture.cols - 1 - col;
                plane(row, col) =
                    (static_cast<float>(mantissas[i]) + 0.5F) * scale[exponents[i]];
            }
        }
    }
    linearise(image.values(), encoding);
    return image;
}

}  // namespace

const Format kRadianceFormat = {"Radiance", matches, read_radiance_header,
                                decode_radiance};

}  // namespace sateen::io
