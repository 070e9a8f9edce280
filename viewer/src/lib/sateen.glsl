// SPDX-License-Identifier: Apache-2.0
// The evaluation of a material on the GPU (WebGL 2). Names are those of the C++ and of
// docs/theory/evaluation.md, the reference: g, q, T, mean, tone (synthesis/appearance.cpp);
// blend, fade, target, amplify, power (synthesis/interpolate.cpp); displaced, s (evaluate.cpp).
// What a pixel costs: docs/theory/viewer_shader.md.
//
//     radiance = Σ_lights E/π max(0, offset + gain (x s)^power),   x = Σ_k w_k v_k(u)
//
// with barycentric weights w of subspaces in the triangles of measured directions [CAR2 §III],
// the texture v_k of each, and the shading s of the surface. Each texture is read once for all
// lights. Branches that skip work are loops: renderers in software run both sides of an `if`.

precision highp float;
precision highp int;
precision highp sampler2DArray;
precision highp usampler2D;

uniform sampler2DArray fields;  // layer k: g of every plane, toroidal, (g + G) / 2G
uniform sampler2D curves;       // rows (k, level): q(g) of every plane
uniform sampler2D hidden;       // column k, row level: variance of each band that the level hides,
                                // and the share of the luminance's variance that it keeps
uniform usampler2D viewCells;   // triangulated views: core/direction_mesh.hpp
uniform usampler2D lightCells;  // the same of lights, then (z, ∛z) of every light
uniform usampler2D pairs;       // e of every pair and its subspace, lights outermost
uniform sampler2D surface;      // unit normal N, height h in texels; a torus
uniform sampler2D moments;      // means of s = max(0, N·l), s², √s over the surface, by l
uniform sampler2DArray cells;   // layers 2k, 2k + 1: m and s of the pattern
uniform sampler2D phase;        // B⁻¹ D, toroidal like the fields
uniform sampler2D toneCurves;   // rows (k, level): c of every plane of the pattern
uniform vec4 subspaces[SUBSPACES * SUBSPACE_ROWS];
uniform vec4 latticeInverse;    // B⁻¹ by rows
uniform vec2 surfaceSize;       // of its torus, in texels
uniform vec2 fieldSize;         // of the torus of fields, in texels
uniform vec2 texelsPerUv;
uniform vec2 heightRange;       // smallest and largest height, in texels
uniform float relief;           // scale of heights; 0 switches relief off
uniform bool marched;           // displacement and self-shadow, not shading alone
uniform vec3 tint;
uniform float exposure;
uniform int viewMode;           // VIEW_*
uniform vec3 palette[SUBSPACES];

varying vec2 vUv;
varying vec3 vNormal;
varying vec3 vViewPosition;

const int VIEW_COMBINED = 0;
const int VIEW_SMOOTH = 1;
const int VIEW_RELIEF = 2;
const int VIEW_INDEX = 3;

const float G = 4.2;            // g runs from -G to G …
const float G_NODES = 85.0;     // … in nodes 0.1 apart, which all knots of a marginal are
const vec3 LUMINANCE = vec3(0.2126390059, 0.7151686788, 0.0721923154);

// Rows of each in `subspaces`; the first three are T.
const int ROW_MEAN = 3;         // of the transform; tone in w
const int ROW_TEXTURE = 4;      // mean of the texture
const int ROW_COVARIANCE = 5;   // F: covariance of luminances j and k is F_j · F_k
const int ROW_SHAPE = 6;        // TextureMoments::shape
const int ROW_LOW = 7;          // of the tone curves: first abscissa of each plane
const int ROW_SCALE = 8;        // and 1 over their length

// ---------------------------------------------------------------- directions

struct Corners {
    ivec3 number;
    vec3 w;
};

uvec4 in_list(usampler2D list, int at) {
    return texelFetch(list, ivec2(at % LIST_COLS, at / LIST_COLS), 0);
}

// DirectionMesh::interpolate: the square of the stereographic map (x, y) / (1 + z) that d is in
// names a cell, from which a walk leads across the border that d is furthest beyond. The weights
// are s_k = row_k · d, of sum 1; past the rim (in a sector) the third counts as 0.
Corners corners_of(usampler2D mesh, vec3 d) {
    vec2 at = clamp((d.xy / (1.0 + d.z) * 0.5 + 0.5) * float(START_SIDE), 0.0, float(START_SIDE - 1));
    int square = int(at.y) * START_SIDE + int(at.x);
    uvec4 four = in_list(mesh, square >> 2);
    int cell = int(four[square & 3]);
    uvec4 a, b, c;
    vec3 s;
    for (int walk = 0; walk < 8; ++walk) {
        int first = START_SIDE * START_SIDE / 4 + 3 * cell;
        a = in_list(mesh, first);
        b = in_list(mesh, first + 1);
        c = in_list(mesh, first + 2);
        s = vec3(dot(uintBitsToFloat(a.xyz), d), dot(uintBitsToFloat(b.xyz), d), dot(uintBitsToFloat(c.xyz), d));
        if (min(s.x, min(s.y, s.z)) >= -1e-5) break;
        cell = int((s.x <= min(s.y, s.z) ? a.w : s.y <= s.z ? b.w : c.w) >> 16);
    }
    if ((c.w & 0x8000u) != 0u) s.z = 0.0;
    s = max(s, 0.0);
    float sum = s.x + s.y + s.z;
    return Corners(ivec3(uvec3(a.w, b.w, c.w) & 0x7FFFu), sum > 0.0 ? s / sum : vec3(1.0, 0.0, 0.0));
}

// ---------------------------------------------------------------- fields without repetition

// Three tiles with shifts by hash overlap at every place of a triangular grid. Their sum,
// weighted by w with the variance kept, is a Gaussian field again [Heitz & Neyret 2018]:
//     g = Σ w_i g_i / √(Σ w_i²)
struct Tiles {
    vec2 at0, at1, at2;
    vec3 w;
};

vec2 tile_shift(ivec2 vertex) {
    uvec2 v = uvec2(vertex) * uvec2(0x9E3779B9u, 0x85EBCA6Bu);
    uint h = v.x ^ (v.y + (v.x << 6) + (v.x >> 2));
    h ^= h >> 16; h *= 0x7FEB352Du; h ^= h >> 15; h *= 0x846CA68Bu; h ^= h >> 16;
    return vec2(h & 0xFFFFu, h >> 16) / 65536.0;
}

Tiles tiles_at(vec2 st) {
    Tiles t;
#ifdef REPEAT
    t.at0 = t.at1 = t.at2 = st;
    t.w = vec3(1.0, 0.0, 0.0);
#else
    const float EDGES = 1.5;  // of the grid along a tile: longer waves than its edge are lost
    vec2 skewed = mat2(1.0, 0.0, -0.57735027, 1.15470054) * (st * EDGES);
    ivec2 base = ivec2(floor(skewed));
    vec3 f = vec3(fract(skewed), 0.0);
    f.z = 1.0 - f.x - f.y;
    ivec2 a, b, c;
    if (f.z > 0.0) {
        t.w = vec3(f.z, f.y, f.x);
        a = base; b = base + ivec2(0, 1); c = base + ivec2(1, 0);
    } else {
        t.w = vec3(-f.z, 1.0 - f.y, 1.0 - f.x);
        a = base + 1; b = base + ivec2(1, 0); c = base + ivec2(0, 1);
    }
    t.w /= length(t.w);
    t.at0 = st + tile_shift(a);
    t.at1 = st + tile_shift(b);
    t.at2 = st + tile_shift(c);
#endif
    return t;
}

vec3 field_at(Tiles t, int k, vec2 dx, vec2 dy) {
    float layer = float(k);
    vec3 g = t.w.x * (textureGrad(fields, vec3(t.at0, layer), dx, dy).xyz * 2.0 - 1.0);
#ifndef REPEAT
    g += t.w.y * (textureGrad(fields, vec3(t.at1, layer), dx, dy).xyz * 2.0 - 1.0);
    g += t.w.z * (textureGrad(fields, vec3(t.at2, layer), dx, dy).xyz * 2.0 - 1.0);
#endif
    return g * G;
}

#ifdef PATTERN
// u(x) = B⁻¹ (x + D(x)): D is a Gaussian field as well, and blended with the others.
vec2 phase_at(vec2 texel, Tiles t, vec2 dx, vec2 dy) {
    vec2 shift = t.w.x * textureGrad(phase, t.at0, dx, dy).xy;
#ifndef REPEAT
    shift += t.w.y * textureGrad(phase, t.at1, dx, dy).xy;
    shift += t.w.z * textureGrad(phase, t.at2, dx, dy).xy;
#endif
    vec2 x = texel.yx - 0.5;  // (row, column); pixels are whole numbers there
    return vec2(dot(latticeInverse.xy, x), dot(latticeInverse.zw, x)) + shift;
}
#endif

// ---------------------------------------------------------------- appearance

// srgb_decode, and ½ of its second derivative.
vec3 decode(vec3 code) {
    return mix(code / 12.92, pow((code + 0.055) / 1.055, vec3(2.4)), step(0.04045, code));
}
vec3 half_curvature(vec3 code) {
    return step(0.04045, code) * (0.5 * 2.4 * 1.4 / (1.055 * 1.055)) * pow((max(code, 0.0) + 0.055) / 1.055, vec3(0.4));
}

// What the fields, and a pattern's phase, are at the place that a pixel sees.
struct Place {
    Tiles tiles;
    vec2 dx, dy;    // of the fields' coordinates
    float level;
    vec2 u;         // of the pattern's cell, and its derivatives
    vec2 udx, udy;
};

// A curve of each plane at places x from 0 to 1, where a texture has them as nodes of its rows.
vec3 curve_at(sampler2D curve, vec3 x, float row) {
    x = (clamp(x, 0.0, 1.0) * (G_NODES - 1.0) + 0.5) / G_NODES;
    return vec3(texture(curve, vec2(x.x, row)).x, texture(curve, vec2(x.y, row)).y, texture(curve, vec2(x.z, row)).z);
}

// v = tone⁻¹(Tᵀ X + mean), X = q(g), or c(m(u) + s(u) q(g)) of a pattern: invert_spectral,
// apply_periodic_layer.
//
// At mip level m a field is an average over a pixel. The curves of that level are already
// E[q(g + hidden part)]; the tone's curve is taken to second order in the variance that the
// level hides, E[f(x)] ≈ f(x) + ½ f''(x) s². So a distant texture keeps its mean colour.
vec3 texture_at(Place place, int k, vec4 hides) {
    int row = k * SUBSPACE_ROWS;
    float level = clamp(place.level, 0.0, float(LEVELS - 1));
    float curve_row = (float(k * LEVELS) + level + 0.5) / float(SUBSPACES * LEVELS);
    vec3 q = curve_at(curves, field_at(place.tiles, k, place.dx, place.dy) * (0.5 / G) + 0.5, curve_row);
#ifdef PATTERN
    vec2 at = place.u.yx + CELL_HALF_TEXEL;
    vec3 m = textureGrad(cells, vec3(at, float(2 * k)), place.udx.yx, place.udy.yx).xyz;
    vec3 s = textureGrad(cells, vec3(at, float(2 * k + 1)), place.udx.yx, place.udy.yx).xyz;
    q = curve_at(toneCurves, (m + s * q - subspaces[row + ROW_LOW].xyz) * subspaces[row + ROW_SCALE].xyz, curve_row);
#endif
    vec4 mean = subspaces[row + ROW_MEAN];
    vec3 v = max(mean.xyz + q.x * subspaces[row].xyz + q.y * subspaces[row + 1].xyz + q.z * subspaces[row + 2].xyz, 0.0);
    return mean.w == 0.0 ? v : decode(v) + half_curvature(v) * hides.xyz;
}

// ---------------------------------------------------------------- surface

float height_at(vec2 texel, float level) {
    return relief * textureLod(surface, texel / surfaceSize, level).w;
}

// How many steps a ray takes between the highest and the lowest height: one a texel of the level
// that it passes over, so that flat and distant surfaces cost little.
int steps_over(vec2 slope, float depth, float level, int most) {
    return int(min(ceil(length(slope) * depth * exp2(-max(level, 0.0))), float(most)));
}

// Where the ray towards the eye leaves the surface: `displaced` of evaluate.hpp, by a linear
// search and a secant step. `texel` is where it meets the plane of height 0.
vec3 relief_hit(vec2 texel, vec3 view, float level) {
    vec2 slope = vec2(view.x, -view.y) / max(view.z, 0.1);
    float top = relief * heightRange.y;
    float depth = top - relief * heightRange.x;
    int steps = steps_over(slope, depth, level, RELIEF_STEPS);
    float z = top;
    float step_size = depth / float(max(steps, 1));
    float above = 0.0;
    for (int i = 0; i <= steps; ++i) {
        float next = top - step_size * float(i);
        float below = next - height_at(texel + slope * next, level);
        if (below <= 0.0) {
            z = i == 0 ? next : next + step_size * (-below / max(above - below, 1e-6));
            break;
        }
        above = below;
        z = next;
    }
    return vec3(texel + slope * z, z);
}

// 1 in light, 0 where the surface hides the light: is_shadowed, with a soft edge.
float self_shadow(vec3 hit, vec3 light, float level) {
    vec2 slope = vec2(light.x, -light.y) / max(light.z, 0.1);
    float depth = relief * (heightRange.y - heightRange.x);
    float start = hit.z + 0.01 * depth;
    float rise = relief * heightRange.y - start;
    int steps = steps_over(slope, rise, level, SHADOW_STEPS);
    float over = -depth;
    for (int i = 1; i <= steps; ++i) {
        float up = rise * float(i) / float(steps);
        over = max(over, height_at(hit.xy + slope * up, level) - start - up);
    }
    return 1.0 - clamp(over / (0.03 * depth + 1e-4), 0.0, 1.0);
}

// Mean over a pixel of max(0, N·l): N is the mean of the pixel's normals, whose length tells how
// much they vary; for a Gaussian N·l of mean μ and variance v it is near ½(μ + √(μ² + 2v/π)).
float lit(vec3 N, vec3 light, float level) {
    float mean = dot(N, light);
    float spread = level > 0.0 ? max(0.0, 1.0 - dot(N, N)) * (1.0 - 0.5 * light.z * light.z) * 0.5 : 0.0;
    return 0.5 * (mean + sqrt(mean * mean + spread * 0.63661977));
}

vec3 shading_moments(vec3 light) {
    vec2 at = (light.xy / (1.0 + max(light.z, 0.0)) * 0.5 + 0.5) * float(MOMENT_SIDE - 1) + 0.5;
    return max(texture(moments, at / float(MOMENT_SIDE)).xyz, 1e-4);
}

// ---------------------------------------------------------------- interpolation

// One light: what DirectionalInterpolation::at finds for it, and the blend of textures.
struct Light {
    vec3 irradiance;
    float s;             // shading of the place, of mean 1
    float C_s, h_s;      // ln(E s² / (E s)²), -8 ln(E √s / √E s) over the surface
    float height;        // cos θ
    float fade;
    vec4 e;              // encoded mean colour and contrast
    vec3 x, mean;        // Σ w v, Σ w mean
    vec4 F, shape;       // Σ w F, Σ w Y shape
    float kept;          // share of the texture's variance at this level
};

const int LIGHTS = NUM_DIR_LIGHTS + 1;

// 1. The 3 x 3 products: weights of subspaces, e, and the fade of the light.
void interpolate(Corners view, inout Light light, vec3 direction, int at, inout float weight[LIGHTS * SUBSPACES], inout uint seen) {
#ifdef MEASURED
    Corners l = corners_of(lightCells, direction);
    vec2 heights = vec2(0.0);
    for (int i = 0; i < 3; ++i) {
        uvec4 z = in_list(lightCells, LIGHT_HEIGHTS + l.number[i]);
        heights += l.w[i] * uintBitsToFloat(z.xy);
        for (int j = 0; j < 3; ++j) {
            float w = l.w[i] * view.w[j];
            uvec4 pair = in_list(pairs, l.number[i] * VIEWS + view.number[j]);
            uint k = pair.w & 0xFFu;
            weight[at * SUBSPACES + int(k)] += w;
            light.e += w * vec4(uintBitsToFloat(pair.xyz), unpackHalf2x16(pair.w >> 16).x);
            if (w > 0.0) seen |= 1u << k;
        }
    }
#ifdef COSINE_INCLUDED
#ifdef REFLECTANCE
    float interpolated = heights.y * heights.y * heights.y;
#else
    float interpolated = heights.x;
#endif
    light.fade = min(4.0, light.height / max(interpolated, 1e-3));
#endif
#else
    weight[at * SUBSPACES] = 1.0;
    seen = 1u;
#endif
}

// 4 to 6. Mean colour and contrast of these directions in place of the blend's own:
// max(0, offset + gain (x s)^power). A mip level that keeps a share of the variance keeps as
// much of what the power takes off the mean.
vec3 value_of(Light light) {
    vec3 x = light.x * light.s;
#ifdef REFLECTANCE
    vec3 e = max(light.e.xyz, 0.0);
    vec3 target = light.fade * e * e * e;
    vec3 mean = max(light.mean, 1e-6);
    float Y = max(dot(LUMINANCE, light.mean), 1e-6);
    vec4 shape = light.shape / Y;
    float C = log(1.0 + dot(light.F, light.F) / (Y * Y));
    float h = C + C * C * shape.w;
    C = max(C + light.C_s, 1e-6);
    float H = clamp(h + light.h_s, 0.5 * C, 2.83 * C);
    float p = log2(4.0 * C / H);
    float wanted = max(0.0, light.e.w);
    float power = clamp(pow(log(1.0 + wanted * wanted) / C, 1.0 / p), 0.5, 1.0);
    float amplify = min(3.0, wanted / sqrt(max(exp(C * pow(power, p)) - 1.0, 1e-6)));
    vec3 c = (shape.xyz * h + light.h_s) * (1.0 + (C / H - 1.0) * (power - 0.5) / 1.5);
    vec3 E = exp(-0.5 * power * (1.0 - power) * c * light.kept);
    return max(vec3(0.0), target * (1.0 - amplify + amplify * pow(max(x, 0.0) / mean, vec3(power)) / E));
#else
    return light.fade * x;
#endif
}

// ---------------------------------------------------------------- a pixel

mat3 tangent_frame(vec3 N) {
    vec3 q0 = dFdx(vViewPosition);
    vec3 q1 = dFdy(vViewPosition);
    vec2 st0 = dFdx(vUv);
    vec2 st1 = dFdy(vUv);
    vec3 T = -(cross(q1, N) * st0.x + cross(N, q0) * st1.x);
    T -= N * dot(N, T);
    T = dot(T, T) < 1e-20 ? normalize(cross(vec3(0.0, 1.0, 0.0), N)) : normalize(T);
    return mat3(T, cross(N, T), N);
}

Light light_from(vec3 irradiance, vec3 direction) {
    Light light;
    light.irradiance = direction.z > 0.0 ? irradiance : vec3(0.0);
    light.height = max(direction.z, 0.0);
    light.fade = light.height;
    light.s = 1.0;
    light.C_s = light.h_s = light.kept = 0.0;
    light.e = light.F = light.shape = vec4(0.0);
    light.x = light.mean = vec3(0.0);
    return light;
}

vec3 sateen_radiance() {
    vec3 N = normalize(vNormal);
#ifdef DOUBLE_SIDED
    N *= gl_FrontFacing ? 1.0 : -1.0;
#endif
    mat3 frame = tangent_frame(N);
    vec3 view = normalize(vViewPosition) * frame;
    view = normalize(vec3(view.xy, max(view.z, 0.001)));

    // Rows of textures run downwards.
    vec2 texel = vec2(vUv.x, -vUv.y) * texelsPerUv;
    Place place;
    vec2 dx = dFdx(texel);
    vec2 dy = dFdy(texel);
    // As anisotropic filtering chooses it: by the shorter axis, up to ANISOTROPY to 1.
    vec2 axes = vec2(dot(dx, dx), dot(dy, dy));
    place.level = 0.5 * log2(max(max(min(axes.x, axes.y), max(axes.x, axes.y) / (ANISOTROPY * ANISOTROPY)), 1e-8));

    vec3 normal = vec3(0.0, 0.0, 1.0);
    vec3 hit = vec3(texel, 0.0);
    bool rough = false;
#ifdef SURFACE
    rough = relief > 0.0 && viewMode != VIEW_SMOOTH && viewMode != VIEW_INDEX;
    if (rough) {
        if (marched) hit = relief_hit(texel, view, place.level);
        vec3 n = textureLod(surface, hit.xy / surfaceSize, place.level).xyz;
        float size = dot(n, n);
        normal = vec3(relief * n.xy, n.z);
        normal *= sqrt(size / dot(normal, normal));
    }
#endif

    Corners view_corners = Corners(ivec3(0), vec3(1.0, 0.0, 0.0));
#ifdef MEASURED
    view_corners = corners_of(viewCells, view);
#endif
    float weight[LIGHTS * SUBSPACES];
    for (int i = 0; i < LIGHTS * SUBSPACES; ++i) weight[i] = 0.0;
    uint seen = 0u;
    Light lights[LIGHTS];
    vec3 clay = vec3(0.0);

#if NUM_DIR_LIGHTS > 0
    for (int i = 0; i < NUM_DIR_LIGHTS; ++i) {
        vec3 direction = directionalLights[i].direction * frame;
        lights[i] = light_from(directionalLights[i].color, direction);
#ifdef SURFACE
        if (rough) {
            float shadow = marched ? self_shadow(hit, direction, place.level) : 1.0;
            float shade = lit(normal, direction, place.level);
            clay += lights[i].irradiance * shade * shadow;
#ifdef DELIT
            vec3 mean = shading_moments(direction);
            lights[i].s = shade / mean.x;
            lights[i].C_s = log(max(1.0, mean.y / (mean.x * mean.x)));
            lights[i].h_s = -8.0 * log(min(1.0, mean.z / sqrt(mean.x)));
#endif
            lights[i].s *= shadow;
        }
#endif
        interpolate(view_corners, lights[i], direction, i, weight, seen);
    }
#endif
    // Light from everywhere is taken to come from the normal, which is exact for a matt surface.
    vec3 ambient = ambientLightColor;
#if NUM_HEMI_LIGHTS > 0
    vec3 bent = normalize(frame * normal);
    for (int i = 0; i < NUM_HEMI_LIGHTS; ++i)
        ambient += getHemisphereLightIrradiance(hemisphereLights[i], bent);
#endif
    lights[NUM_DIR_LIGHTS] = light_from(ambient, vec3(0.0, 0.0, 1.0));
    if (ambient != vec3(0.0))
        interpolate(view_corners, lights[NUM_DIR_LIGHTS], vec3(0.0, 0.0, 1.0), NUM_DIR_LIGHTS, weight, seen);
    clay += ambient;

    const float RECIPROCAL_PI_ = 0.3183098861837907;
    if (viewMode == VIEW_RELIEF) return exposure * clay * 0.5 * RECIPROCAL_PI_;
    if (viewMode == VIEW_INDEX) {
        vec3 sum = vec3(0.0);
        for (int k = 0; k < SUBSPACES; ++k) sum += weight[k] * palette[k];
        return sum;
    }

    vec2 st = hit.xy / fieldSize;
    place.tiles = tiles_at(st);
    place.dx = dx / fieldSize;
    place.dy = dy / fieldSize;
#ifdef PATTERN
    place.u = phase_at(hit.xy, place.tiles, place.dx, place.dy);
    place.udx = vec2(dot(latticeInverse.xy, dx.yx), dot(latticeInverse.zw, dx.yx));
    place.udy = vec2(dot(latticeInverse.xy, dy.yx), dot(latticeInverse.zw, dy.yx));
#endif
    float level_row = (clamp(place.level, 0.0, float(LEVELS - 1)) + 0.5) / float(LEVELS);
    for (uint rest = seen; rest != 0u; rest &= rest - 1u) {
        // The lowest bit: the exponent of its value as a float.
        int k = int(floatBitsToUint(float(rest & (~rest + 1u))) >> 23) - 127;
        vec4 hides = texture(hidden, vec2((float(k) + 0.5) / float(SUBSPACES), level_row));
        vec3 v = texture_at(place, k, hides);
        vec4 mean = subspaces[k * SUBSPACE_ROWS + ROW_TEXTURE];
        float Y = dot(LUMINANCE, mean.xyz);
        for (int i = 0; i < LIGHTS; ++i) {
            float w = weight[i * SUBSPACES + k];
            lights[i].x += w * v;
            lights[i].mean += w * mean.xyz;
            lights[i].F += w * subspaces[k * SUBSPACE_ROWS + ROW_COVARIANCE];
            lights[i].shape += w * Y * subspaces[k * SUBSPACE_ROWS + ROW_SHAPE];
            lights[i].kept += w * hides.w;
        }
    }
    vec3 radiance = vec3(0.0);
    for (int i = 0; i < LIGHTS; ++i) radiance += lights[i].irradiance * value_of(lights[i]);
    return exposure * tint * radiance * RECIPROCAL_PI_;
}
