#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <map>
#include <cmath>

#include "baker/bake/ship_meshes.hpp"
#include "baker/compress/cpca.hpp"
#include "baker/effects/diffuse/direct.hpp"
#include "baker/import/gltf.hpp"
#include "baker/transport/ray_scene.hpp"
#include "runtime/bundle/transfer_codec.hpp"

using namespace lambent;
using namespace lambent::baker;

// order of first use
static std::vector<std::uint32_t> meshOrder(const GroupGeometry& g, const SampleSet& s) {
  std::vector<std::uint32_t> order; std::vector<bool> seen(s.size());
  auto put=[&](std::uint32_t x){ if(!seen[x]){seen[x]=true; order.push_back(x);} };
  for (auto x : s.vertex_sample) put(x);
  (void)g;
  for (std::uint32_t x=0;x<s.size();++x) put(x);
  return order;
}

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  std::vector<double> bounds; int outputs=1; bool direct=false; unsigned clusters=0; bool one=false;
  for (int i=2;i<argc;++i){ if(!strcmp(argv[i],"--direct")) direct=true; else if(!strcmp(argv[i],"--one")) one=true; else if(!strncmp(argv[i],"--k=",4)) clusters=unsigned(atoi(argv[i]+4)); else if(!strncmp(argv[i],"--outputs=",10)) outputs=atoi(argv[i]+10); else bounds.push_back(atof(argv[i])/100); }
  if (bounds.empty()) bounds={0.01,0.005,0.003,0.001};
  const auto scene = importScene(argv[1]);
  const auto groups = findRigidGroups(*scene);
  Progress progress;
  const auto meshes = shipMeshes(*scene, groups, 0.0f, progress, {});
  const GroupGeometry geometry = buildGroupGeometry(groups.at(0), *scene, meshes->decoded);
  const SampleSet samples = buildSamples(geometry);
  const auto rays = RayScene::build(geometry, *scene, *loadAlphaMaps(*scene));
  constexpr int kOrder = 5;
  TransferField field = *bakeDirect(geometry, samples, *rays, {kOrder, getenv("RAYS")?size_t(atoi(getenv("RAYS"))):512}, progress, {});
  const std::size_t N = samples.size();
  // stand-in bounce
  std::vector<float> bounce = field.vectors, next;
  const auto edges = sampleEdges(geometry, samples);
  for (int it=0; it<12; ++it){
    next = bounce; std::vector<float> deg(N,1.0f);
    for (auto [a,b] : edges){ deg[a]+=1; deg[b]+=1; for(int i=0;i<25;++i){ next[a*25+i]+=bounce[b*25+i]; next[b*25+i]+=bounce[a*25+i]; } }
    for (size_t s=0;s<N;++s) for(int i=0;i<25;++i) next[s*25+i]/=deg[s];
    bounce.swap(next);
  }
  bundle::TransferShape shape; shape.order=5; shape.shadowed_channels=1; shape.full_channels= direct?0:3;
  const double albedo[3]={0.8,0.5,0.3};
  std::vector<float> vectors;
  std::vector<float> cell;
  const auto order = meshOrder(geometry, samples);
  for (auto s : order) {
    for(int i=0;i<25;++i) vectors.push_back(field.vectors[s*25+i]);
    if(!direct) for(int c=0;c<3;++c) for(int i=0;i<25;++i) vectors.push_back(float(field.vectors[s*25+i]+0.3*albedo[c]*bounce[s*25+i]));
  }
  (void)outputs;
  const size_t V = geometry.positions.size();
  std::printf("%s: %zu vertices %zu samples %zu values\n", argv[1], V, N, size_t(shape.size()));
  for (double bound : bounds) for (unsigned k : one ? std::vector<unsigned>{1u} : std::vector<unsigned>{1u, clusters}) {
    double secs=0; size_t cb=0, ib=0, wb=0; double err=0; size_t K=0; double axes=0; size_t planes=0; size_t wide=0;
    for (size_t first=0; first<N; first+=65536) {
      const size_t count=std::min<size_t>(65536,N-first);
      const auto t0=std::chrono::steady_clock::now();
      const CodedTransfer coded = baker::codeTransfer(std::span(vectors).subspan(first*shape.size(),count*shape.size()), count, shape, {float(bound),k});
      secs += std::chrono::duration<double>(std::chrono::steady_clock::now()-t0).count();
      const int L = getenv("ZL")?atoi(getenv("ZL")):9;
      cb += bundle::compressZstd(bundle::encodeCodebook(coded.codebook),L).size();
      ib += bundle::compressZstd(bundle::encodeClusterIds(coded.cluster_of, unsigned(coded.codebook.clusters())),L).size();
      for (auto& p : coded.planes){ wb += bundle::compressZstd(bundle::encodeWeightPlane(p.codes,p.bits),L).size(); axes+=double(p.codes.size()); wide+=p.bits==16; }
      
      if (getenv("ENT")) {
        auto H=[](const std::vector<int>& v){ std::map<int,int> h; for(int x:v) h[x]++; double b=0; for(auto&[x,n]:h) b-=n*std::log2(double(n)/double(v.size())); return b/8; };
        // order of codes
        std::vector<unsigned> cnt(coded.codebook.clusters()); for(auto c:coded.cluster_of) cnt[c]++;
        double raw=0,rawc=0; double d[6]={0},dc[6]={0}; double r2=0;
        for (auto& p: coded.planes){ std::vector<int> v(p.codes.begin(),p.codes.end()); raw+=H(v);
          for(int sh=0;sh<4;++sh){ std::vector<int> e; int acc=0; for(size_t i=0;i<v.size();++i){ int pr=acc>>8; e.push_back(v[i]-pr); acc+=((v[i]<<8)-acc)>>sh; } d[sh]+=H(e);
            size_t o=0; for(auto n:cnt){ if(o>=v.size()) break; std::vector<int> g(e.begin()+long(o),e.begin()+long(o+n)); dc[sh]+=H(g); o+=n; } }
          { std::vector<int> e; for(size_t i=0;i<v.size();++i){ int a=i>0?v[i-1]:0,b=i>1?v[i-2]:a; e.push_back(v[i]-(3*a+b)/4);} d[4]+=H(e); }
          { std::vector<int> e; for(size_t i=0;i<v.size();++i){ int a=i>0?v[i-1]:0,b=i>1?v[i-2]:a; e.push_back(v[i]-(a+b)/2);} d[5]+=H(e); }
          size_t o=0; for(auto n:cnt){ if(o>=v.size()) break; std::vector<int> g(v.begin()+long(o),v.begin()+long(o+n)); rawc+=H(g); o+=n; }
        }
        printf("  entropy raw %.2f per cluster %.2f; smooth0 %.2f/%.2f s1 %.2f/%.2f s2 %.2f/%.2f s3 %.2f/%.2f; 3a+b %.2f a+b %.2f\n",raw/double(V),rawc/double(V),d[0]/double(V),dc[0]/double(V),d[1]/double(V),dc[1]/double(V),d[2]/double(V),dc[2]/double(V),d[3]/double(V),dc[3]/double(V),d[4]/double(V),d[5]/double(V)); (void)r2;
      }
      err=std::max(err,double(coded.error)); K+=coded.codebook.clusters(); planes=std::max(planes,coded.planes.size());
    }
    std::printf("bound %.2f %% clusters %4zu axes %5.2f planes %zu (%zu wide) bytes/vertex %.2f = %.2f book + %.2f ids + %.2f weights  error %.3f %%  %.2f s\n", bound*100,K,axes/double(N),planes,wide,double(cb+ib+wb)/double(V),double(cb)/double(V),double(ib)/double(V),double(wb)/double(V),err*100,secs);
    std::fflush(stdout);
  }
}
