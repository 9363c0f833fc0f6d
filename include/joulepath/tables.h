/**
 * The tables that ship, in ROM: one for each file of src/tables/, which names the command that made it of a robot file.
 * Include the header of the module that takes a table. Made by: make tables
 */
#ifndef JOULEPATH_TABLES_H
#define JOULEPATH_TABLES_H

#ifdef __cplusplus
extern "C" {
#endif

struct jp_battery_cells;
struct jp_battery_config;
struct jp_energy_model;
struct jp_factor_learning;
struct jp_four_wheel_energy_model;
struct jp_four_wheel_robot_config;
struct jp_horizon;
struct jp_lattice;
struct jp_learning;
struct jp_localiser_config;
struct jp_navigator_body;
struct jp_path_drive_config;
struct jp_path_limits;
struct jp_patrol_config;
struct jp_patrol_scanner;
struct jp_pure_pursuit_config;
struct jp_robot_config;
struct jp_skid_energy_model;
struct jp_skid_learning;
struct jp_skid_robot_config;
struct jp_skid_steer_config;

extern const struct jp_battery_cells jp_battery_cells_burger;
extern const struct jp_battery_cells jp_battery_cells_courier24;
extern const struct jp_battery_cells jp_battery_cells_patrol;
extern const struct jp_battery_cells jp_battery_cells_zhang2018;
extern const struct jp_battery_config jp_battery_config_burger;
extern const struct jp_battery_config jp_battery_config_courier24;
extern const struct jp_battery_config jp_battery_config_patrol;
extern const struct jp_battery_config jp_battery_config_zhang2018;
extern const struct jp_energy_model jp_energy_model_courier24;
extern const struct jp_energy_model jp_energy_model_courier24_battery;
extern const struct jp_energy_model jp_energy_model_gao2018;
extern const struct jp_energy_model jp_energy_model_gao2018_battery;
extern const struct jp_energy_model jp_energy_model_published;
extern const struct jp_factor_learning jp_four_wheel_learning_patrol;
extern const struct jp_four_wheel_energy_model jp_four_wheel_energy_patrol;
extern const struct jp_four_wheel_robot_config jp_four_wheel_robot_patrol;
extern const struct jp_horizon jp_horizon_courier24;
extern const struct jp_horizon jp_horizon_courier24_battery;
extern const struct jp_horizon jp_horizon_gao2018;
extern const struct jp_horizon jp_horizon_gao2018_battery;
extern const struct jp_lattice jp_lattice_burger;
extern const struct jp_lattice jp_lattice_courier24;
extern const struct jp_lattice jp_lattice_gao2018;
extern const struct jp_lattice jp_lattice_zhang2018;
extern const struct jp_lattice jp_lattice_zhang2018_navigation;
extern const struct jp_learning jp_learning_courier24;
extern const struct jp_learning jp_learning_courier24_battery;
extern const struct jp_learning jp_learning_gao2018;
extern const struct jp_learning jp_learning_gao2018_battery;
extern const struct jp_localiser_config jp_localiser_config_patrol;
extern const struct jp_navigator_body jp_navigation_burger;
extern const struct jp_navigator_body jp_navigation_courier24;
extern const struct jp_navigator_body jp_navigation_zhang2018;
extern const struct jp_path_drive_config jp_path_drive_burger;
extern const struct jp_path_drive_config jp_path_drive_zhang2018;
extern const struct jp_path_limits jp_path_limits_burger;
extern const struct jp_path_limits jp_path_limits_zhang2018;
extern const struct jp_patrol_config jp_patrol_config_patrol;
extern const struct jp_patrol_scanner jp_patrol_scanner_patrol;
extern const struct jp_pure_pursuit_config jp_pure_pursuit_config_patrol;
extern const struct jp_robot_config jp_robot_courier24;
extern const struct jp_robot_config jp_robot_gao2018;
extern const struct jp_skid_energy_model jp_skid_energy_burger;
extern const struct jp_skid_energy_model jp_skid_energy_zhang2018;
extern const struct jp_skid_learning jp_skid_learning_burger;
extern const struct jp_skid_learning jp_skid_learning_zhang2018;
extern const struct jp_skid_robot_config jp_skid_robot_burger;
extern const struct jp_skid_robot_config jp_skid_robot_zhang2018;
extern const struct jp_skid_steer_config jp_skid_steer_burger;
extern const struct jp_skid_steer_config jp_skid_steer_zhang2018;

#ifdef __cplusplus
}
#endif

#endif
