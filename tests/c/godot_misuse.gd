# Everything that a script can do wrong with samples/godot, each once: godot_test.cpp looks for what is said.
# Usage: godot3-server --path build/godot --script tests/c/godot_misuse.gd --asset=FILE.sinew
extends SceneTree

var scripts = {
	"World": preload("res://addons/sinew/sinew_world.gdns"),
	"Character": preload("res://addons/sinew/sinew_character.gdns")}


func make(name, node, asset = ""):
	node.set_script(scripts[name])
	if asset != "":
		node.asset = asset
	return node


func _initialize():
	var asset = ""
	for words in OS.get_cmdline_args():
		if words.begins_with("--asset="):
			asset = words.substr(8)
	var world = make("World", Spatial.new())
	root.add_child(world)
	world.running = false

	var orphan = make("Character", Skeleton.new(), asset)
	root.add_child(orphan)
	orphan.play("walk")
	orphan.free()
	var text = make("Character", Skeleton.new(), "res://main.gd")
	world.add_child(text)
	text.free()
	var stranger = make("Character", Skeleton.new(), asset)
	stranger.add_bone("tentacle")
	world.add_child(stranger)
	stranger.push("chest", Vector3(1, 0, 0))
	world.step()
	stranger.free()

	var hero = make("Character", Skeleton.new(), asset)
	world.add_child(hero)
	hero.clip = "swim"
	hero.play(99)
	hero.play(Vector3())
	hero.push("tail", Vector3(1, 0, 0))
	hero.push("chest", 5)
	hero.push("chest")
	hero.push(99, Vector3(1, 0, 0))
	hero.push("chest", Vector3(NAN, 0, 0))
	hero.set_strength(-1)
	hero.asset = "res://other.sinew"
	hero.balance = true
	world.steps_per_second = 0
	world.throw_ball(Vector3(), Vector3(), -1)
	world.ball_transform(7)

	var elsewhere = make("World", Spatial.new())
	root.add_child(elsewhere)
	world.step()
	world.remove_child(hero)
	world.step()
	world.add_child(hero)
	world.step()
	print("still %d bones, %s the animation" % [hero.get_bone_count(), "on" if hero.is_on_animation() else "off"])
	world.remove_child(hero)
	elsewhere.add_child(hero)
	elsewhere.step()
	world.free()
	hero.play("walk")
	elsewhere.step()
	elsewhere.free()
	print("all are gone")
	quit()
