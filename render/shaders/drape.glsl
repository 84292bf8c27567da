// An image on the land and on the globe around it; the twin of render/ground/drape.h.
// Units: image coordinates 0 .. 1, v down; linear albedo out.
layout(std140, binding = 2) uniform DrapeBlock {
    vec4 globe; // image coordinates = (longitude, latitude in radians - xy) * zw; zw 0: not on the globe
    vec4 map;   // coordinates in the map = DEM sample * xy + zw
    vec4 image; // x: 1 where it goes around the globe
} drape;

layout(binding = 10) uniform sampler2D drape_image;
layout(binding = 11) uniform sampler2D drape_map;

// rgb: linear albedo; a: 0 outside the image, softly.
vec4 drape_texel(vec2 uv, vec2 dx, vec2 dy) {
    vec4 texel = textureGrad(drape_image, uv, dx, dy);
    vec2 inside = min(uv, 1.0 - uv) * 200.0;
    inside.x = max(inside.x, drape.image.x * 9.0);
    return vec4(pow(texel.rgb, vec3(2.2)), texel.a * clamp(min(inside.x, inside.y), 0.0, 1.0));
}

// noise: -1 .. 1, lends the image the grain that its pixels lack near the eye.
vec3 drape_over(vec3 albedo, vec2 dem_sample, float noise) {
    vec2 uv = textureLod(drape_map, dem_sample * drape.map.xy + drape.map.zw, 0.0).rg;
    vec4 image = drape_texel(uv, dFdx(uv), dFdy(uv));
    return mix(albedo, image.rgb * (1.0 + 0.2 * noise), image.a);
}

// at: from the Earth's middle, ECEF stretched so that the ellipsoid is a sphere.
vec4 drape_on_globe(vec3 at) {
    if (drape.globe.z == 0.0)
        return vec4(0.0);
    vec3 up = normalize(at * vec3(1.0, 1.0, 1.0033640898));
    float longitude = atan(up.y, up.x), turn = 6.28318531 * drape.globe.z;
    vec2 uv = (vec2(longitude, asin(clamp(up.z, -1.0, 1.0))) - drape.globe.xy) * drape.globe.zw;
    uv.x -= floor(uv.x / turn) * turn;
    // The longitude jumps at the antimeridian; the derivative of the shorter way is the true one.
    vec2 dx = dFdx(uv), dy = dFdy(uv);
    dx.x -= round(dx.x / turn) * turn;
    dy.x -= round(dy.x / turn) * turn;
    return drape_texel(uv, dx, dy);
}
