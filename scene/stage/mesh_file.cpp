#include "scene/stage/mesh_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <stdexcept>
#include <type_traits>

#include <assimp/DefaultLogger.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "base/input_file.h"
#include "render/data/mesh.h"
#include "scene/stage/apart.h"
#include "scene/stage/convex_hull.h"
#include "scene/stage/convex_pieces.h"
#include "scene/stage/mesh_text.h"
#include "scene/stage/overlap.h"

namespace headpin::scene {
namespace {

constexpr std::size_t kMostBytes = 16'000'000, kMostTriangles = 200'000;
constexpr std::size_t kMostCorners = 20'000, kMostVertices = 1000;  // of a polyhedron
constexpr unsigned kMostSecondsToCut = 10;
constexpr const char* kHalfRead = "its reader was cut short";
constexpr double kFarthest = 1e3;  // that a point may be [m]

/// The extension in small letters.
std::string kind_of(const std::filesystem::path& path) {
  std::string kind = path.extension().string();
  for (char& c : kind) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return kind;
}

bool is_gltf(const std::string& kind) {
  return kind == ".gltf" || kind == ".glb";
}

/// The unchanged content of a file.
struct Read {
  std::vector<aiVector3D> points;
  std::vector<aiVector3D> normals;  // of the points, 0 where the file has none; then of the corners
  std::vector<aiColor4D> colours;   // of the points
  std::vector<std::uint32_t> sizes, corners;  // of each face; its points
  std::vector<char> unseen;                   // as MeshData has it
};

template <typename T>
void put(std::string& bytes, const std::vector<T>& list) {
  static_assert(std::is_trivially_copyable_v<T> || std::is_same_v<T, aiColor4D> ||
                std::is_same_v<T, aiVector3D>);
  const std::size_t size = list.size();
  bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
  bytes.append(reinterpret_cast<const char*>(list.data()), size * sizeof(T));
}

/// Reads the data of put(). It is not trusted, because a file may have made its writer write
/// anything.
template <typename T>
void take(std::string_view& bytes, std::vector<T>& list) {
  std::size_t size = 0;
  if (bytes.size() < sizeof size) throw std::runtime_error(kHalfRead);
  std::memcpy(&size, bytes.data(), sizeof size);
  bytes.remove_prefix(sizeof size);
  if (size > bytes.size() / sizeof(T)) throw std::runtime_error(kHalfRead);
  list.resize(size);
  if (size > 0) std::memcpy(static_cast<void*>(list.data()), bytes.data(), size * sizeof(T));
  bytes.remove_prefix(size * sizeof(T));
}

/// A file system of one file.
class OneFile : public Assimp::IOSystem {
 public:
  OneFile(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}
  bool Exists(const char* name) const override { return name == name_; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char*) override {
    if (!Exists(name)) return nullptr;
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes_.data()),
                                      bytes_.size());
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  std::string_view bytes_;
  std::string name_;
};

/// Stores the first error that assimp reports but would ignore.
class FirstError : public Assimp::LogStream {
 public:
  explicit FirstError(std::string& text) : text_(text) {}
  void write(const char* message) override {
    if (text_.empty()) text_ = message;
  }

 private:
  std::string& text_;
};

/// A message of assimp, without the prefix of its log and the end of its line.
std::string in_words_of_assimp(const std::string& kind, std::string text) {
  if (text.starts_with("Error, T")) text.erase(0, text.find(": ") + 2);
  while (!text.empty() && (text.back() == '\n' || text.back() == '.')) text.pop_back();
  return fmt::format("expected a whole {} file; its reader, assimp, says: {}", kind, text);
}

/// The purpose of a mesh. For the eyes, surfaces that are visible from both sides are stored twice.
enum class For { eyes, collisions };

/// Appends a mesh at the pose of its node. A mirror reverses the corners of faces (glTF 2.0,
/// section 3.7.4).
void append(Read& all, const aiMesh& mesh, const aiMatrix4x4& X, bool turned, bool other_side) {
  const auto base = static_cast<std::uint32_t>(all.points.size());
  const aiMatrix3x3 for_normals = aiMatrix3x3(X).Inverse().Transpose();
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    all.points.push_back(X * mesh.mVertices[i]);
    const aiVector3D n = mesh.HasNormals() ? for_normals * mesh.mNormals[i] : aiVector3D();
    all.normals.push_back(other_side ? -n : n);
  }
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    all.sizes.push_back(face.mNumIndices);
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      all.corners.push_back(base + face.mIndices[turned ? face.mNumIndices - 1 - k : k]);
    }
  }
}

/// Appends as many colours as append() adds points: those of the points, times that of the
/// material.
void append_colours(Read& all, const aiMesh& mesh, const aiMaterial* gltf_material) {
  aiColor4D plain(1.0F, 1.0F, 1.0F, 1.0F);
  const bool has_plain =
      gltf_material != nullptr && gltf_material->Get(AI_MATKEY_BASE_COLOR, plain) == AI_SUCCESS;
  if (!has_plain && !mesh.HasVertexColors(0)) return;
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    all.colours.push_back(mesh.HasVertexColors(0) ? plain * mesh.mColors[0][i] : plain);
  }
}

using Key = std::array<float, 9>;

/// A key that has an order even if a value is not a number.
Key key_of(const aiVector3D& p, const aiVector3D& n = {}, const aiColor4D& c = {}) {
  Key key{p.x, p.y, p.z, n.x, n.y, n.z, c.r, c.g, c.b};
  for (float& x : key) x = std::isfinite(x) ? x : 0.0F;
  return key;
}

bool has_direction(const aiVector3D& n) {
  return std::isfinite(n.SquareLength()) && n.SquareLength() > 0.0F;
}

/// Normals of each triangle's corners: those of the file. If the file has none, or 0, it is the
/// mean of the faces there within 50 degrees of its own face, so that sharp edges stay sharp.
std::vector<aiVector3D> normals_of_corners(const Read& all) {
  constexpr float kSmooth = 0.64279F;  // cosine of 50 degrees
  std::vector<aiVector3D> normals, faces;
  std::vector<std::pair<Key, std::size_t>> by_place;  // corners
  bool all_said = true;
  for (std::size_t i = 0; i < all.corners.size(); ++i) {
    const auto point = [&](std::size_t k) { return all.points[all.corners[i - i % 3 + k]]; };
    normals.push_back(all.normals[all.corners[i]]);
    faces.push_back(((point(1) - point(0)) ^ (point(2) - point(0))).NormalizeSafe());
    all_said = all_said && has_direction(normals[i]);
  }
  if (all_said) return normals;
  for (std::size_t i = 0; i < all.corners.size(); ++i) {
    by_place.emplace_back(key_of(all.points[all.corners[i]]), i);
  }
  std::ranges::sort(by_place);
  for (auto first = by_place.begin(); first != by_place.end();) {
    const auto end = std::find_if(first, by_place.end(),
                                  [&](const auto& other) { return other.first != first->first; });
    for (auto one = first; one != end; ++one) {
      aiVector3D& n = normals[one->second];
      if (has_direction(n)) continue;
      n = {};
      for (auto k = first; k != end; ++k) {
        if (faces[k->second] * faces[one->second] >= kSmooth) n += faces[k->second];
      }
    }
    first = end;
  }
  return normals;
}

/// The meshes of a node and of those below it.
void append(Read& all, const aiScene& scene, const aiNode& node, const aiMatrix4x4& X_parent,
            bool gltf, For whom) {
  const aiMatrix4x4 X = X_parent * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
    const bool has_material = gltf && mesh.mMaterialIndex < scene.mNumMaterials;
    const aiMaterial* material = has_material ? scene.mMaterials[mesh.mMaterialIndex] : nullptr;
    const bool turned = X.Determinant() < 0.0F;
    int both = 0;
    if (has_material && whom == For::eyes) material->Get(AI_MATKEY_TWOSIDED, both);
    for (const bool other_side : {false, true}) {
      if (other_side && both == 0) break;
      append(all, mesh, X, turned != other_side, other_side);
      append_colours(all, mesh, material);
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) {
    append(all, scene, *node.mChildren[c], X, gltf, whom);
  }
}

/// Runs in a separate process, because assimp trusts the sizes in a file.
std::string read_by_assimp(std::string_view bytes, const std::string& kind, unsigned flags,
                           For whom) {
  Read all;
  const std::string unseen = unseen_of_mesh(kind, bytes);
  all.unseen.assign(unseen.begin(), unseen.end());
  std::string complaint;
  Assimp::DefaultLogger::create(nullptr, Assimp::Logger::NORMAL, 0);
  Assimp::DefaultLogger::get()->attachStream(new FirstError(complaint), Assimp::Logger::Err);
  if (kind == ".ply") require_whole_ply(bytes);
  const std::string obj = kind == ".obj" ? plain_obj(bytes) : "";
  Assimp::Importer importer;
  importer.SetIOHandler(new OneFile(obj.empty() ? bytes : obj, "mesh" + kind));
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile("mesh" + kind, flags | aiProcess_ValidateDataStructure);
  if (scene == nullptr) {
    const std::string why = importer.GetErrorString();
    if (why.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
    throw std::runtime_error(in_words_of_assimp(kind, why));
  }
  if (!complaint.empty()) throw std::runtime_error(in_words_of_assimp(kind, complaint));
  append(all, *scene, *scene->mRootNode, {}, is_gltf(kind), whom);
  if (whom == For::eyes) all.normals = normals_of_corners(all);
  std::string out;
  put(out, all.points);
  put(out, all.normals);
  put(out, all.colours);
  put(out, all.sizes);
  put(out, all.corners);
  put(out, all.unseen);
  return out;
}

/// @throws std::runtime_error  with the reason alone
Read read_apart(std::string_view file, const std::string& kind, unsigned flags, For whom) {
  const std::string told = apart([&] { return read_by_assimp(file, kind, flags, whom); }, {});
  std::string_view bytes = told;
  Read all;
  take(bytes, all.points);
  take(bytes, all.normals);
  take(bytes, all.colours);
  take(bytes, all.sizes);
  take(bytes, all.corners);
  take(bytes, all.unseen);
  require_faces(all.sizes, all.corners, all.points.size());
  return all;
}

/// Transform from a file's numbers to metres, x right, y ahead, z up.
struct FromFile {
  Mat3 R;
  double unit;

  std::string name;  ///< of the file

  FromFile(const std::string& path, const MeshMeasure& measure) : unit(measure.unit), name(path) {
    if (!(unit > 0.0 && std::isfinite(unit))) {
      throw std::invalid_argument(fmt::format("{}: unit {}, expected above 0", path, unit));
    }
    R = rotation_of(measure, path);
  }

  Vec3 point(const aiVector3D& v) const {
    const Vec3 p = unit * (R * Vec3(v.x, v.y, v.z));
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > kFarthest) {
      throw std::invalid_argument(
          fmt::format("{}: a point at {:.3g}, {:.3g}, {:.3g} m, expected within {:g} m", name,
                      p.x(), p.y(), p.z(), kFarthest));
    }
    return p;
  }
};

Vec3 light_of(const aiColor4D& c, bool linear) {
  const Vec3 code(c.r, c.g, c.b);
  const Vec3 in_range = code.array().isFinite().select(code, 0.0).cwiseMax(0.0).cwiseMin(1.0);
  return linear ? in_range : render::light_of(in_range);
}

template <typename F>
auto naming(const std::filesystem::path& path, F&& f) {
  try {
    return f();
  } catch (const std::runtime_error& e) {
    throw std::runtime_error(path.string() + ": " + e.what());
  }
}

/// Flat faces with shared points [m].
struct Flat {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
};

Flat welded(const Read& all, const FromFile& from) {
  if (all.points.size() > kMostCorners) {
    throw std::runtime_error(
        fmt::format("{} corners of faces, expected at most {}", all.points.size(), kMostCorners));
  }
  std::vector<Vec3> corners;
  Vec3 low = Vec3::Constant(kFarthest), high = -low;
  for (const aiVector3D& v : all.points) {
    corners.push_back(from.point(v));
    low = low.cwiseMin(corners.back());
    high = high.cwiseMax(corners.back());
  }
  Flat flat;
  const std::vector<std::uint32_t> index =
      weld(corners, kWelded * (high - low).norm(), flat.points);
  std::size_t at = 0;
  for (const std::uint32_t size : all.sizes) {
    std::vector<std::uint32_t>& face = flat.faces.emplace_back();
    for (std::uint32_t k = 0; k < size; ++k) face.push_back(index[all.corners[at++]]);
  }
  return flat;
}

/// The triangles of a file, without those that welding made a line.
Surface read_surface(std::string_view bytes, const std::filesystem::path& path,
                     const FromFile& from) {
  Flat flat =
      welded(read_apart(bytes, kind_of(path), aiProcess_Triangulate, For::collisions), from);
  Surface surface{.points = std::move(flat.points), .triangles = {}};
  for (const std::vector<std::uint32_t>& f : flat.faces) {
    if (f.size() != 3 || f[0] == f[1] || f[1] == f[2] || f[2] == f[0]) continue;
    surface.triangles.push_back({f[0], f[1], f[2]});
  }
  return surface;
}

/// convex_pieces() in a separate process, because a hostile surface may take it any time.
std::vector<engine::Polyhedron> pieces_apart(const Surface& surface, std::size_t most) {
  const auto work = [&] {
    std::string out;
    for (const engine::Polyhedron& piece : convex_pieces(surface, most)) {
      std::vector<double> numbers;
      std::vector<std::uint32_t> sizes, corners;
      for (const Vec3& p : piece.vertices()) numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
      for (const engine::Polyhedron::Face& face : piece.faces()) {
        sizes.push_back(face.count);
        for (const std::uint32_t corner : piece.corners(face)) corners.push_back(corner);
      }
      put(out, numbers);
      put(out, sizes);
      put(out, corners);
    }
    return out;
  };
  const std::string told = apart(work, {.cpu_s = kMostSecondsToCut});
  std::vector<engine::Polyhedron> pieces;
  for (std::string_view bytes = told; !bytes.empty();) {
    std::vector<double> numbers;
    std::vector<std::uint32_t> sizes, corners;
    take(bytes, numbers);
    take(bytes, sizes);
    take(bytes, corners);
    require_faces(sizes, corners, numbers.size() / 3);
    Flat flat;
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) {
      flat.points.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    }
    if (flat.points.size() > kMostVertices) {
      throw std::runtime_error(fmt::format("{} vertices in a convex piece, expected at most {}",
                                           flat.points.size(), kMostVertices));
    }
    auto corner = corners.begin();
    for (const std::uint32_t size : sizes) {
      flat.faces.emplace_back(corner, corner + size);
      corner += size;
    }
    pieces.emplace_back(std::move(flat.points), flat.faces);
  }
  return pieces;
}

}  // namespace

std::string read_mesh_file(const std::filesystem::path& path) {
  const std::string name = path.string(), kind = kind_of(path);
  constexpr std::array kinds{".gltf", ".glb", ".obj", ".ply", ".stl", ".off"};
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
    throw std::runtime_error(
        fmt::format("{}: kind \"{}\", expected .gltf, .glb, .obj, .ply, .stl or .off", name, kind));
  }
  std::string bytes = base::read_text(name, kMostBytes);
  if (bytes.empty()) throw std::runtime_error(name + ": expected a mesh, found an empty file");
  return bytes;
}

MeshData mesh_of(std::string_view bytes, const std::filesystem::path& path,
                 const MeshMeasure& measure) {
  const FromFile from(path.string(), measure);
  return naming(path, [&] {
    const std::string kind = kind_of(path);
    const Read all =
        read_apart(bytes, kind, aiProcess_Triangulate | aiProcess_SortByPType, For::eyes);
    if (all.sizes.size() > kMostTriangles) {
      throw std::runtime_error(
          fmt::format("{} triangles, expected at most {}", all.sizes.size(), kMostTriangles));
    }
    if (all.normals.size() != all.corners.size() || all.corners.size() != 3 * all.sizes.size()) {
      throw std::runtime_error(kHalfRead);
    }
    const bool coloured = all.colours.size() == all.points.size();
    std::map<Key, std::uint32_t> alike;  // (Assimp's own function mixes up colours.)
    MeshData mesh;
    mesh.unseen.assign(all.unseen.begin(), all.unseen.end());
    for (std::size_t i = 0; i < all.corners.size(); ++i) {
      const std::uint32_t at = all.corners[i];
      const aiColor4D colour = coloured ? all.colours[at] : aiColor4D();
      const auto [one, is_new] = alike.try_emplace(key_of(all.points[at], all.normals[i], colour),
                                                   static_cast<std::uint32_t>(mesh.points.size()));
      mesh.triangles.push_back(one->second);
      if (!is_new) continue;
      mesh.points.push_back(from.point(all.points[at]));
      const Vec3 n = from.R * Vec3(all.normals[i].x, all.normals[i].y, all.normals[i].z);
      const bool has_length = n.allFinite() && n.norm() > 0.0;  // otherwise the area is 0
      mesh.normals.push_back(has_length ? Vec3(n.normalized()) : Vec3::UnitZ());
      if (coloured) mesh.colours.push_back(light_of(colour, is_gltf(kind)));
    }
    return mesh;
  });
}

std::vector<engine::Polyhedron> polyhedra_of(std::string_view bytes,
                                             const std::filesystem::path& path,
                                             const MeshMeasure& measure, std::size_t most) {
  const FromFile from(path.string(), measure);
  return naming(path, [&] {
    const Flat flat = welded(read_apart(bytes, kind_of(path), 0, For::collisions), from);
    if (flat.points.size() <= kMostVertices) {
      try {
        return std::vector{engine::Polyhedron(flat.points, flat.faces)};
      } catch (
          const std::invalid_argument&) {  // not convex, or not even closed: this is said below
      }
    }
    return pieces_apart(read_surface(bytes, path, from), most);
  });
}

double added_by(std::span<const engine::Polyhedron> pieces, std::string_view bytes,
                const std::filesystem::path& path, const MeshMeasure& measure) {
  const FromFile from(path.string(), measure);
  return naming(path, [&] {
    const Surface surface = read_surface(bytes, path, from);
    const Bounds box = bounds_of(surface);
    const std::size_t columns = columns_for(surface);
    const auto enclosed_by = [&](const Surface& s) {
      return volume_of(s) - overlap_of(s, box, columns);
    };
    Surface all;
    for (const engine::Polyhedron& piece : pieces) append(all, surface_of(piece));
    return enclosed_by(all) / enclosed_by(surface) - 1.0;
  });
}

}  // namespace headpin::scene
