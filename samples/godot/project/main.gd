# A walker is pushed, hit by a ball, knocked down, and gets up. Somebody else keeps his balance until he is knocked down, too;
# his Skeleton is not made by Sinew but has the bones of a model. The first three seconds are the run of samples/c.
#
# Usage: godot3-server --path FOLDER --fixed-fps 60 --asset=FILE.sinew --model=FILE.glb [--out=POSES]
# --out writes what the skeletons say after every step, as samples/godot/compare.cpp reads it.
extends Spatial

const FRAMES = 600

var frame = 0
var ball = -1
var touches = 0
var hash_of_poses = 0
var out = null

onready var world = $World
onready var hero = $World/Hero
onready var bystander = $World/Bystander


# Before the characters enter the tree, where they read their assets.
func _enter_tree():
	$World/Hero.asset = argument("asset")
	$World/Bystander.asset = argument("asset")
	if argument("model") != "":
		add_bones($World/Bystander, argument("model"))


func _ready():
	if hero.get_bone_count() == 0:
		give_up("the hero has no bones")
		return
	if argument("out") != "":
		out = File.new()
		if out.open(argument("out"), File.WRITE) != OK:
			give_up(argument("out") + " cannot be written")
			return
	ball = world.throw_ball(Vector3(3, 1.5, 0), Vector3(-6, 2, 1.2), 4)
	world.connect("stepped", self, "_on_stepped")
	hero.connect("contact_began", self, "_on_contact")
	hero.connect("left_animation", self, "_on_told", ["physics takes over"])
	hero.connect("returned_to_animation", self, "_on_told", ["on the animation"])


func _on_stepped():
	frame += 1
	$World/Ball.transform = world.ball_transform(ball)
	hash_of_poses = hero.pose_hash() if frame == 1 else hero.pose_hash(hash_of_poses)
	if out:
		write_poses()
	match frame:
		60:
			hero.push("chest", Vector3(90, 0, 0))
		180:
			print_hash()
			world.move_ball(ball, Vector3(2, 1.6, 3.8), Vector3(-8, 0, 1.2))
		240:
			hero.knock_down()
			bystander.knock_down()
		420:
			tell_heights()
			hero.get_up()
			bystander.get_up()
		FRAMES:
			tell_heights()
			print("%d touches" % touches)
			print_hash()
			if out:
				out.close()
			get_tree().quit()


func _on_contact(bone, with, _position, impulse):
	touches += 1
	if with == "prop":
		_on_told("the ball hits %s with %.1f N s" % [hero.get_bone_name(bone), impulse.length()])


func _on_told(what):
	print("frame %d: %s" % [frame, what])


func tell_heights():
	for who in [hero, bystander]:
		var pelvis = who.get_bone_global_pose(who.find_bone("pelvis")).origin.y
		var where = "on" if who.is_on_animation() else "off"
		_on_told("%s's pelvis is at %.2f m, %s the animation" % [who.name, pelvis, where])


func print_hash():
	print("pose hash %08x%08x" % [(hash_of_poses >> 32) & 0xffffffff, hash_of_poses & 0xffffffff])


func argument(name):
	for words in OS.get_cmdline_args():
		if words.begins_with("--" + name + "="):
			return words.substr(name.length() + 3)
	return ""


func give_up(why):
	printerr("godot: ", why)
	get_tree().quit(1)


# ---- What a game does not need: bones and files for the comparison ----

# The bones of a glTF file, which the editor imports and a server does not. Each is turned about its origin, as those of
# other programs are, and what the right hand holds comes before all others.
func add_bones(skeleton, path):
	var file = File.new()
	if file.open(path, File.READ) != OK:
		give_up(path + " cannot be opened")
		return
	file.seek(12)
	var length = file.get_32()
	file.get_32()
	var gltf = parse_json(file.get_buffer(length).get_string_from_utf8())
	var joints = gltf["skins"][0]["joints"]
	skeleton.add_bone("sword")
	for joint in joints:
		skeleton.add_bone(gltf["nodes"][joint]["name"])
	for joint in joints:
		var node = gltf["nodes"][joint]
		for child in node.get("children", []):
			skeleton.set_bone_parent(skeleton.find_bone(gltf["nodes"][child]["name"]), skeleton.find_bone(node["name"]))
	for joint in joints:
		var node = gltf["nodes"][joint]
		var bone = skeleton.find_bone(node["name"])
		var parent = skeleton.get_bone_parent(bone)
		var at = Vector3(node["translation"][0], node["translation"][1], node["translation"][2])
		var unturned = Transform() if parent < 0 else turn_of(parent).inverse()
		skeleton.set_bone_rest(bone, unturned * Transform(Basis(), at) * turn_of(bone))
	skeleton.set_bone_parent(0, skeleton.find_bone("hand_r"))
	skeleton.set_bone_rest(0, Transform(Basis(), Vector3(0, 0.1, 0)))


func turn_of(bone):
	return Transform(Basis(Vector3(1, 2, 3).normalized(), 0.3 * bone), Vector3())


func write_poses():
	for bone in hero.get_bone_count():
		write(hero.get_bone_pose(bone))
		write(hero.get_bone_global_pose(bone))
	for bone in hero.get_bone_count():
		var its = bystander.find_bone(hero.get_bone_name(bone))
		write(bystander.transform * bystander.get_bone_global_pose(its) * turn_of(its).inverse())


func write(transform):
	for column in [transform.basis.x, transform.basis.y, transform.basis.z, transform.origin]:
		out.store_float(column.x)
		out.store_float(column.y)
		out.store_float(column.z)
