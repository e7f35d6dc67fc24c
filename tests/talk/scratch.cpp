#include "study/talk/judges.h"
#include <cstdio>
#include <numbers>
#include "fixtures/paths.h"
using namespace sinew; using namespace sinew::study;
static scene::Scene load(const char* n){ scene::Scene s; auto e=scene::load_scene(std::string("/work/wt/talk/assets/scenes/talk/")+n+".json",s); if(e) puts(e.message.c_str()); return s; }
static double pend(double seconds){ auto f=[](double q){return -1.5*9.81*std::sin(q);}; double q=std::numbers::pi/2,v=0; const double h=1e-4; for(int n=0;n<std::lround(seconds/h);++n){double v2=v+h/2*f(q),v3=v+h/2*f(q+h/2*v),v4=v+h*f(q+h/2*v2); double a1=f(q),a2=f(q+h/2*v),a3=f(q+h/2*v2),a4=f(q+h*v3); q+=h/6*(v+2*v2+2*v3+v4); v+=h/6*(a1+2*a2+2*a3+a4);} return q; }
int main(int argc,char**argv){ std::string what=argv[1];
 if(what=="hinge") for(bool dbl:{false,true}) for(double hz:{30.,60.,120.,240.,480.}) { auto s=load("hinge"); s.frame_rate=hz; s.double_precision=dbl; if(dbl) s.world.accuracy.tolerance=1e-9; Played p(s); double worst=0,amp=0; for(int f=0;f<p.judge().frames();++f){ double q=pend(f/hz); Eigen::Vector3d w(-std::sin(q),0,1.4-std::cos(q)); auto t=point_at(p,f,0,0,{0,0,-1}); worst=std::max(worst,(t-w).norm()); if(f>p.judge().frames()/2) amp=std::max(amp,t.z()); } printf("%d %g worst %g top %g\n",dbl,hz,worst,amp); }
 if(what=="bar"){ auto s=load("bar"); Played p(s); auto j=p.judge(); for(int f=1;f<j.frames();f+=6){ double z=(j.center_of_mass(f,0).z()+j.center_of_mass(f-1,0).z())/2; printf("%.2f K %.2f total %.2f rep %.2f\n",f/60.,j.kinetic(f,0),j.kinetic(f,0)+75*9.81*z,p.telemetry.rows[f].report.kinetic_energy+p.telemetry.rows[f].report.potential_energy);} }
 if(what=="baked") for(double k:{0.05,0.1,0.2,0.3,0.5,1.0}) for(double dur:{0.6,1.0,1.5}) { printf("impulse x %g, %g s:",k,dur); for(double d:{0.,0.5,2.,8.,32.}){ auto s=load("baked"); s.duration=dur; for(auto&p:s.pushes)p.impulse*=k; s.world.detail.baked_decay=d; Played p(s); double sq=0;int n=0; double most=0; for(int f=0;f<p.judge().frames();++f) for(const char*h:{"hand_l","hand_r"}){int i=joint_named(s,0,h); double o=joint_at(p,f,0,i).rotation.angularDistance(joint_at(p,f,1,i).rotation); sq+=o*o;++n; most=std::max(most,o);} printf("  d=%g %.2f (%.1f)",d,std::sqrt(sq/n)*57.3,most*57.3);} puts(""); }
}
