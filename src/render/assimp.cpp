#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "core/error.h"
#include "core/names.h"
#include "render/module_doors.h"

namespace chromeball::render::assimp {
namespace {

namespace fs = std::filesystem;

Error failure(const std::string& path, const std::string& why) {
    return {Error::Kind::failed, fmt::format("{}: {}", path, why)};
}

/// What the loader would tell worse, or try and crash at.
void check_file(const std::string& path, const LoadLimits& limits) {
    std::error_code error;
    const auto status = fs::status(path, error);
    if (!fs::exists(status)) throw failure(path, "no such file, and no mesh of that name");
    if (!fs::is_regular_file(status)) throw failure(path, "is no file; a mesh file is wanted");
    const std::uintmax_t size = fs::file_size(path, error);
    if (error) throw failure(path, error.message());
    if (size == 0) throw failure(path, "is empty");
    if (size > limits.file_bytes)
        throw failure(path, fmt::format("has {} MB, more than the {} MB that are read; simplify it",
                                        size >> 20, limits.file_bytes >> 20));
}

V3f color_of(const aiMaterial& material, bool& found) {
    aiColor4D c;
    found = aiGetMaterialColor(&material, AI_MATKEY_BASE_COLOR, &c) == AI_SUCCESS ||
            aiGetMaterialColor(&material, AI_MATKEY_COLOR_DIFFUSE, &c) == AI_SUCCESS;
    return found ? V3f(c.r, c.g, c.b) : V3f(0.8F, 0.8F, 0.8F);
}

/// A material by its name where that is one of ours ("mirror", "gold.001"), else by its numbers:
/// polished metal is a mirror, light that it sends out is flat, the rest is matte.
Material material_of(const aiMaterial& material) {
    aiString name;
    material.Get(AI_MATKEY_NAME, name);
    bool has_color = false;
    const V3f color = color_of(material, has_color);
    aiColor3D glow(0, 0, 0);
    if (material.Get(AI_MATKEY_COLOR_EMISSIVE, glow) == AI_SUCCESS &&
        std::max({glow.r, glow.g, glow.b}) > 0)
        return {.kind = Material::Kind::flat, .color = {glow.r, glow.g, glow.b}};
    std::string text = name.C_Str();
    text = text.substr(0, text.find('.'));
    if (auto known = find_material(text)) {
        if (known->kind == Material::Kind::diffuse && has_color) known->color = color;
        return *known;
    }
    float metal = 0, rough = 1;
    material.Get(AI_MATKEY_METALLIC_FACTOR, metal);
    material.Get(AI_MATKEY_ROUGHNESS_FACTOR, rough);
    if (metal > 0.5F) return {.color = color, .roughness = std::clamp(rough, 0.0F, 1.0F)};
    return {.kind = Material::Kind::diffuse, .color = color};
}

/// One mesh of the file as it stands in the world.
Mesh placed(const aiMesh& from, const aiMatrix4x4& to_world) {
    Mesh mesh;
    for (unsigned i = 0; i < from.mNumVertices; ++i) {
        const aiVector3D p = to_world * from.mVertices[i];
        mesh.positions.emplace_back(p.x, p.y, p.z);
    }
    if (from.HasNormals()) {
        aiMatrix3x3 turn(to_world);
        turn.Inverse().Transpose();
        for (unsigned i = 0; i < from.mNumVertices; ++i) {
            const aiVector3D n = turn * from.mNormals[i];
            mesh.normals.emplace_back(n.x, n.y, n.z);
        }
    }
    // A node that mirrors turns its faces over.
    const bool mirrored = aiMatrix3x3(to_world).Determinant() < 0;
    for (unsigned i = 0; i < from.mNumFaces; ++i) {
        const aiFace& face = from.mFaces[i];
        if (face.mNumIndices != 3) continue;
        mesh.triangles.push_back(
            {face.mIndices[0], face.mIndices[mirrored ? 2 : 1], face.mIndices[mirrored ? 1 : 2]});
    }
    return mesh;
}

/// Goes through a file's nodes.
class Walk {
public:
    Walk(const aiScene& from, const std::string& path, const LoadLimits& limits)
        : from_(from), path_(path), limits_(limits) {}

    void visit(const aiNode& node, const aiMatrix4x4& parent, int depth) {
        constexpr int kDeepest = 1000;
        if (depth > kDeepest) throw failure(path_, "its nodes are nested without end");
        const aiMatrix4x4 to_world = parent * node.mTransformation;
        if (node.mNumMeshes == 0)
            scene.places.push_back(
                {node.mName.C_Str(), V3d(to_world.a4, to_world.b4, to_world.c4)});
        for (unsigned i = 0; i < node.mNumMeshes; ++i) {
            const aiMesh& mesh = *from_.mMeshes[node.mMeshes[i]];
            if (!(mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE)) continue;
            triangles_ += mesh.mNumFaces;
            if (triangles_ > limits_.triangles)
                throw failure(path_, fmt::format("has more than {} triangles; simplify it",
                                                 limits_.triangles));
            Object object;
            object.name = node.mName.length > 0 ? node.mName.C_Str() : mesh.mName.C_Str();
            object.mesh = placed(mesh, to_world);
            object.material = material_of(*from_.mMaterials[mesh.mMaterialIndex]);
            scene.objects.push_back(std::move(object));
        }
        for (unsigned i = 0; i < node.mNumChildren; ++i)
            visit(*node.mChildren[i], to_world, depth + 1);
    }

    /// Needs the nodes' places: after visit().
    void add_camera(const aiCamera& camera) {
        const aiNode* node = from_.mRootNode->FindNode(camera.mName);
        aiMatrix4x4 to_world;
        for (const aiNode* at = node; at; at = at->mParent)
            to_world = at->mTransformation * to_world;
        const aiMatrix3x3 turn(to_world);
        const aiVector3D ahead = turn * camera.mLookAt, up = turn * camera.mUp;
        const aiVector3D at = to_world * camera.mPosition;
        const V3d back = -V3d(ahead.x, ahead.y, ahead.z).normalized();
        const V3d right = V3d(up.x, up.y, up.z).cross(back).normalized();
        const V3d above = back.cross(right);
        const auto rotation = Rotation::nearest(std::array{
            right.x, above.x, back.x, right.y, above.y, back.y, right.z, above.z, back.z});
        if (!rotation) return;  // a camera that looks nowhere
        // The loader's "horizontal" angle is glTF's vertical one times the aspect.
        const double fov = static_cast<double>(camera.mHorizontalFOV) /
                           (camera.mAspect > 0 ? static_cast<double>(camera.mAspect) : 1.0);
        std::erase_if(scene.places, [&](const Place& p) { return p.name == camera.mName.C_Str(); });
        scene.cameras.push_back({camera.mName.C_Str(), V3d(at.x, at.y, at.z), *rotation,
                                 std::clamp(fov * 180 / std::numbers::pi, 0.01, 179.0)});
    }

    Scene scene;

private:
    const aiScene& from_;
    const std::string& path_;
    const LoadLimits& limits_;
    std::size_t triangles_ = 0;
};

/// What Assimp says of a file that it gives up, and the way out.
[[noreturn]] void give_up(const std::string& path, std::string_view why) {
    // It asks for as much memory as a damaged file says that it needs.
    if (why.find("bad_alloc") != std::string_view::npos)
        throw failure(path, "is damaged, or tells of more than memory holds; export it again");
    throw failure(path, fmt::format("cannot be read as a mesh: {}; export it again", excerpt(why)));
}

}  // namespace

Scene load(const std::string& path, const LoadLimits& limits) {
    check_file(path, limits);
    Assimp::Importer importer;
    const std::string extension = fs::path(path).extension().string();
    if (!importer.IsExtensionSupported(extension))
        throw failure(path, fmt::format("\"{}\" files are not read as meshes; .obj, .ply, .stl, "
                                        ".gltf and .glb are",
                                        excerpt(extension)));
    const aiScene* from = nullptr;
    try {
        from = importer.ReadFile(path, aiProcess_Triangulate | aiProcess_SortByPType);
    } catch (const std::exception& e) {
        give_up(path, e.what());
    }
    if (!from) give_up(path, importer.GetErrorString());
    if (!from->mRootNode) throw failure(path, "has nothing in it");
    Walk walk(*from, path, limits);
    walk.visit(*from->mRootNode, aiMatrix4x4(), 0);
    for (unsigned i = 0; i < from->mNumCameras; ++i) walk.add_camera(*from->mCameras[i]);
    if (walk.scene.objects.empty())
        throw failure(path, "has no faces, only points or lines; a surface is needed");
    return std::move(walk.scene);
}

}  // namespace chromeball::render::assimp
