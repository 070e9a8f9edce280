// SPDX-License-Identifier: Apache-2.0
// Baked maps as binary glTF 2.0 [Khronos, glTF 2.0 Specification, section 4.4].
#include <fmt/format.h>
#include <unistd.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "baked_maps.hpp"
#include "sateen/io/atomic_file.hpp"
#include "sateen/io/image_file.hpp"

namespace sateen::cli {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "glTF is little-endian");

/// The bytes of a PNG, which the writer knows how to make as a file only.
Result<Bytes> png_bytes(ImageView<const float> image, Encoding encoding) {
    std::string path =
        (std::filesystem::temp_directory_path() / "sateen-XXXXXX.png").string();
    const int file = mkstemps(path.data(), 4);
    if (file < 0) return Error{Errc::io, path + ": cannot be created"};
    close(file);
    WriteOptions options;
    options.encoding = encoding;
    options.png_compression = 6;
    const Result<void> written = write_image(path, image, options);
    Result<Bytes> bytes =
        written ? read_file(path, std::size_t{1} << 30U) : Result<Bytes>(written.error());
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    return bytes;
}

void append(Bytes& out, const void* data, std::size_t bytes) {
    const auto* from = static_cast<const std::uint8_t*>(data);
    out.insert(out.end(), from, from + bytes);
}

void append(Bytes& out, std::uint32_t word) {
    append(out, &word, sizeof word);
}

/// Pieces of the binary chunk, each aligned to 4 bytes.
class Buffer {
  public:
    std::size_t add(const void* data, std::size_t bytes, Json extra = Json::object()) {
        bytes_.resize((bytes_.size() + 3) & ~std::size_t{3});
        Json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes}};
        view.update(extra);
        append(bytes_, data, bytes);
        views_.push_back(std::move(view));
        return views_.size() - 1;
    }
    [[nodiscard]] const Bytes& bytes() const { return bytes_; }
    [[nodiscard]] const Json& views() const { return views_; }

  private:
    Bytes bytes_;
    Json views_ = Json::array();
};

/// A quad in the xy plane, its texture upright.
Json add_quad(Buffer& buffer, float width, float height) {
    constexpr int kFloat = 5126;
    constexpr int kShort = 5123;
    constexpr int kVertices = 34962;
    constexpr int kIndices = 34963;
    const float x = width / 2;
    const float y = height / 2;
    const std::array<float, 12> position = {-x, -y, 0, x, -y, 0, x, y, 0, -x, y, 0};
    const std::array<float, 12> normal = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    const std::array<float, 16> tangent = {1, 0, 0, 1, 1, 0, 0, 1,
                                           1, 0, 0, 1, 1, 0, 0, 1};
    const std::array<float, 8> uv = {0, 1, 1, 1, 1, 0, 0, 0};
    const std::array<std::uint16_t, 6> index = {0, 1, 2, 0, 2, 3};
    Json accessors = Json::array();
    const auto add = [&](const auto& data, int component, const char* type, int count,
                         int target) {
        const std::size_t view =
            buffer.add(data.data(), sizeof data, {{"target", target}});
        accessors.push_back({{"bufferView", view},
                             {"componentType", component},
                             {"count", count},
                             {"type", type}});
    };
    add(position, kFloat, "VEC3", 4, kVertices);
    accessors.back()["min"] = {-x, -y, 0};
    accessors.back()["max"] = {x, y, 0};
    add(normal, kFloat, "VEC3", 4, kVertices);
    add(tangent, kFloat, "VEC4", 4, kVertices);
    add(uv, kFloat, "VEC2", 4, kVertices);
    add(index, kShort, "SCALAR", 6, kIndices);
    return accessors;
}

}  // namespace

Result<Bytes> gltf_of(const BakedMaps& maps, const std::string& name) {
    Buffer buffer;
    const bool scaled = maps.width_m > 0;
    const float aspect = static_cast<float>(maps.base_colour.rows()) /
                         static_cast<float>(maps.base_colour.cols());
    const Json accessors =
        add_quad(buffer, scaled ? maps.width_m : 1.0F, scaled ? maps.height_m : aspect);
    // Occlusion, roughness and metalness are the channels of one image.
    Image rough(3, maps.roughness.rows(), maps.roughness.cols());
    const std::size_t pixels = rough.plane_size();
    std::fill_n(rough.plane(0).data, pixels, 1.0F);
    std::copy_n(maps.roughness.plane(0).data, pixels, rough.plane(1).data);

    Json images = Json::array();
    Json textures = Json::array();
    const auto add_image = [&](const Image& image, Encoding encoding,
                               const char* what) -> Result<void> {
        SATEEN_TRY(const Bytes png, png_bytes(image.view(), encoding));
        images.push_back({{"name", what},
                          {"mimeType", "image/png"},
                          {"bufferView", buffer.add(png.data(), png.size())}});
        textures.push_back({{"sampler", 0}, {"source", images.size() - 1}});
        return {};
    };
    SATEEN_CHECK(add_image(maps.base_colour, Encoding::srgb, "base colour"));
    SATEEN_CHECK(add_image(maps.normal, Encoding::linear, "normal"));
    SATEEN_CHECK(add_image(rough, Encoding::linear, "roughness"));

    constexpr int kLinear = 9729;
    constexpr int kLinearMipmapLinear = 9987;
    constexpr int kRepeat = 10497;
    Json json;
    json["asset"] = {{"version", "2.0"}, {"generator", "sateen " SATEEN_VERSION}};
    json["scene"] = 0;
    json["scenes"] = {{{"nodes", {0}}}};
    json["nodes"] = {{{"mesh", 0}, {"name", name}}};
    json["meshes"] = {
        {{"primitives",
          {{{"attributes",
             {{"POSITION", 0}, {"NORMAL", 1}, {"TANGENT", 2}, {"TEXCOORD_0", 3}}},
            {"indices", 4},
            {"material", 0}}}}}};
    json["materials"] = {{{"name", name},
                          {"pbrMetallicRoughness",
                           {{"baseColorTexture", {{"index", 0}}},
                            {"metallicFactor", 0},
                            {"roughnessFactor", 1},
                            {"metallicRoughnessTexture", {{"index", 2}}}}},
                          {"normalTexture", {{"index", 1}}}}};
    json["textures"] = textures;
    json["images"] = images;
    json["samplers"] = {{{"magFilter", kLinear},
                         {"minFilter", kLinearMipmapLinear},
                         {"wrapS", kRepeat},
                         {"wrapT", kRepeat}}};
    json["accessors"] = accessors;
    json["bufferViews"] = buffer.views();
    Bytes binary = buffer.bytes();
    json["buffers"] = {{{"byteLength", binary.size()}}};
    binary.resize((binary.size() + 3) & ~std::size_t{3});
    std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) & ~std::size_t{3}, ' ');

    constexpr std::uint32_t kMagic = 0x46546C67;
    constexpr std::uint32_t kJson = 0x4E4F534A;
    constexpr std::uint32_t kBinary = 0x004E4942;
    Bytes out;
    append(out, kMagic);
    append(out, 2);
    append(out, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + binary.size()));
    append(out, static_cast<std::uint32_t>(text.size()));
    append(out, kJson);
    append(out, text.data(), text.size());
    append(out, static_cast<std::uint32_t>(binary.size()));
    append(out, kBinary);
    append(out, binary.data(), binary.size());
    return out;
}

}  // namespace sateen::cli
