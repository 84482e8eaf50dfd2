#include "render/load.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>

#include "core/error.h"
#include "render/solids.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;
using test::write_text;

class MeshFile : public ::testing::Test {
protected:
    MeshFile() : folder_(fs::temp_directory_path() / ("meshes" + std::to_string(::getpid()))) {
        fs::create_directories(folder_);
    }
    ~MeshFile() override { fs::remove_all(folder_); }

    std::string file(const std::string& name, const std::string& text) const {
        const std::string path = (folder_ / name).string();
        write_text(path, text);
        return path;
    }
    Mesh loaded(const std::string& name, const std::string& text) {
        notes_.clear();
        return load_mesh(file(name, text), notes_);
    }
    std::string refusal(const std::string& path, const LoadLimits& limits = {}) {
        try {
            notes_.clear();
            load_mesh(path, notes_, limits);
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), Error::Kind::failed);
            const std::string text = e.what();
            EXPECT_TRUE(text.starts_with(path + ": ")) << text;
            EXPECT_EQ(text.find('\n'), std::string::npos) << "one line: " << text;
            return text.substr(std::min(text.size(), path.size() + 2));
        }
        return "";
    }
    std::string refused(const std::string& name, const std::string& text) {
        return refusal(file(name, text));
    }

    fs::path folder_;
    std::vector<std::string> notes_;
};

const char* const kTetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

TEST_F(MeshFile, OfEveryKindIsTheSameSolid) {
    const std::string stl = [] {
        std::string text = "solid t\n";
        const char* corners[] = {"0 0 0", "1 0 0", "0 1 0", "0 0 1"};
        for (const auto& f :
             {std::array{0, 2, 1}, std::array{0, 1, 3}, std::array{0, 3, 2}, std::array{1, 2, 3}}) {
            text += "facet normal 0 0 0\nouter loop\n";
            for (const int i : f) text += std::string("vertex ") + corners[i] + "\n";
            text += "endloop\nendfacet\n";
        }
        return text + "endsolid t\n";
    }();
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
        "float z\n"
        "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    for (const auto& [name, text] : {std::pair<std::string, std::string>{"t.obj", kTetrahedron},
                                     {"t.stl", stl},
                                     {"t.ply", ply}}) {
        const Mesh mesh = loaded(name, text);
        EXPECT_EQ(mesh.triangles.size(), 4u) << name;
        EXPECT_NEAR(six_volumes(mesh), 1, 1e-6) << name;
        EXPECT_TRUE(notes_.empty()) << name << notes_.front();
        for (const V3f& n : mesh.normals) EXPECT_NEAR(n.length(), 1, 1e-5);
    }
}

TEST_F(MeshFile, KeepsTheNormalsItHas) {
    const Mesh mesh =
        loaded("n.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0.6 0 0.8\nvn 0 0 2\nf 1//1 2//2 3//1\n");
    ASSERT_EQ(mesh.normals.size(), 3u);
    float most = 0;
    for (const V3f& n : mesh.normals) {
        EXPECT_NEAR(n.length(), 1, 1e-5);
        most = std::max(most, n.x);
    }
    EXPECT_NEAR(most, 0.6, 1e-5);
}

TEST_F(MeshFile, HasPolygonsCutIntoTriangles) {
    EXPECT_EQ(loaded("q.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").triangles.size(),
              2u);
}

TEST_F(MeshFile, ThatIsBadIsOneClearSentence) {
    EXPECT_NE(refusal((folder_ / "none.obj").string()).find("no such file"), std::string::npos);
    EXPECT_NE(refusal(folder_.string()).find("is no file"), std::string::npos);
    EXPECT_EQ(refused("empty.obj", ""), "is empty");
    EXPECT_NE(refused("note.txt", "hello").find("\".txt\" files are not read"), std::string::npos);
    EXPECT_NE(refused("bad.ply", "ply\nformat nonsense\n").find("cannot be read as a mesh"),
              std::string::npos);
    EXPECT_NE(refused("bad.gltf", "{\"asset\": 3").find("cannot be read as a mesh"),
              std::string::npos);
    EXPECT_NE(refused("bad.glb", "glTF but not really one").find("cannot be read as a mesh"),
              std::string::npos);
    EXPECT_NE(refused("bad.stl", "solid\nfacet nonsense").size(), 0u);
    EXPECT_NE(refused("points.obj", "v 0 0 0\nv 1 1 1\n").size(), 0u);
    EXPECT_NE(refused("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n").size(), 0u);
    EXPECT_NE(refused("nan.obj", "v nan 0 0\nv 1 nan 0\nv 0 1 nan\nf 1 2 3\n").size(), 0u);
    EXPECT_NE(refused("flat.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n").find("1 have no area"),
              std::string::npos);
}

#ifndef __SANITIZE_ADDRESS__  // which ends programs that ask for too much

TEST_F(MeshFile, ThatTellsOfMoreThanMemoryHoldsIsSaidToBeDamaged) {
    const std::string head =
        "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\n"
        "property float y\nproperty float z\nelement face 4000000000\n"
        "property list uchar int vertex_indices\nend_header\n";
    // So that no machine is large enough to try.
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_AS, &before), 0);
    rlimit bounded = before;
    bounded.rlim_cur = rlim_t{16} << 30;
    ASSERT_EQ(::setrlimit(RLIMIT_AS, &bounded), 0);
    const std::string message = refused("huge.ply", head + "short");
    ASSERT_EQ(::setrlimit(RLIMIT_AS, &before), 0);
    EXPECT_EQ(message, "is damaged, or tells of more than memory holds; export it again");
}

#endif

TEST_F(MeshFile, ThatIsTooLargeIsRefusedBeforeItIsRead) {
    const std::string path = file("t.obj", kTetrahedron);
    EXPECT_NE(refusal(path, {.file_bytes = 10}).find("more than the"), std::string::npos);
    EXPECT_NE(refusal(path, {.triangles = 3}).find("more than 3 triangles"), std::string::npos);
    EXPECT_EQ(refusal(path, {.triangles = 4}), "");
}

TEST_F(MeshFile, CutOffAnywhereIsReadOrRefusedButNeverWorse) {
    const std::string whole = std::string(kTetrahedron) + "vn 0 0 1\nf 1//1 2//1 3//1\n";
    for (std::size_t length = 1; length < whole.size(); length += 5)
        for (const char* name : {"c.obj", "c.stl", "c.ply", "c.glb", "c.gltf"}) {
            try {
                loaded(name, whole.substr(0, length));
            } catch (const Error&) {
            }
        }
}

/// Two nodes, one of them scaled and moved, one mirrored; materials by name and by numbers.
std::string gltf() {
    // Three positions and three indices of 16 bits, as base64.
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1,2]}],
"nodes":[{"name":"moved","mesh":0,"translation":[10,0,0],"scale":[2,2,2]},
{"name":"turned","mesh":1,"scale":[-1,1,1]},{"name":"probe","translation":[1,2,3]}],
"materials":[{"name":"mirror.001"},{"name":"wall","pbrMetallicRoughness":{"baseColorFactor":[0.25,0.5,0.75,1],"metallicFactor":0}}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]},
{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
"buffers":[{"byteLength":42,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA"}]})";
}

TEST_F(MeshFile, WithNodesIsASceneInTheWorldsAxes) {
    const Scene scene = load_scene(file("s.gltf", gltf()));
    ASSERT_EQ(scene.objects.size(), 2u);
    const Object& moved = scene.objects[0];
    EXPECT_EQ(moved.name, "moved");
    EXPECT_EQ(moved.material, *find_material("mirror"));
    EXPECT_NEAR(box_of(moved.mesh).low.x, 10, 1e-5);
    EXPECT_NEAR(box_of(moved.mesh).high.x, 12, 1e-5);
    const Object& turned = scene.objects[1];
    EXPECT_EQ(turned.material.kind, Material::Kind::diffuse);
    EXPECT_NEAR(turned.material.color.z, 0.75, 1e-5);
    // Mirrored, but still seen from +Z.
    const auto& t = turned.mesh.triangles.at(0);
    const auto& p = turned.mesh.positions;
    EXPECT_GT((p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).z, 0);
    ASSERT_FALSE(scene.places.empty());
    EXPECT_EQ(scene.places.back().name, "probe");
    EXPECT_NEAR((scene.places.back().position - V3d(1, 2, 3)).length(), 0, 1e-9);
}

}  // namespace
}  // namespace chromeball
